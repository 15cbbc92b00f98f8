// Exports of Motive: units, axes, both kinds of rotations, lost bodies, and slips.
#include <gtest/gtest.h>

#include <cmath>

#include "mutants.hpp"
#include "refusals.hpp"
#include "snug/archive_import/internal/readers.hpp"

namespace snug::archive_import::internal {
namespace {

using test::expect_refusal;

std::string header(const std::string& rotation, const std::string& unit, const std::string& columns) {
  return "Format Version,1.23,Take Name,A take,Take Notes,,Capture Frame Rate,120.000000,Export Frame Rate,120.000000,"
         "Rotation Type," +
         rotation + ",Length Units," + unit + ",Coordinate Space,Global\r\n\r\n" + columns;
}

const std::string kQuaternionColumns =
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Marker\r\n"
    ",Name,Crate,Crate,Crate,Crate,Crate,Crate,Crate,Crate,Crate:M1\r\n"
    ",ID,\"A\",\"A\",\"A\",\"A\",\"A\",\"A\",\"A\",\"A\",\"B\"\r\n"
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error,Position\r\n"
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X\r\n";

TEST(Motive, TurnsYUpIntoZUpForPositionsAndBodies) {
  // A quarter turn about Motive's vertical, y, is one about z.
  const double h = std::sqrt(0.5);
  const std::string text = header("Quaternion", "Millimeters", kQuaternionColumns) +
                           "0,0.0,0,0,0,1,100,200,300,0.1,5\r\n" + "1,0.01,0," + std::to_string(h) + ",0," +
                           std::to_string(h) + ",100,200,300,0.1,\r\n";
  const Imported y = read_motive(text, "take.csv", {});
  const record::MotionCaptureLog& log = y.recording.motion_capture;
  ASSERT_EQ(log.bodies.size(), 1U);
  EXPECT_EQ(log.bodies[0].name, "Crate");
  EXPECT_NEAR(log.sample_frequency, 100.0, 1e-9);
  EXPECT_LT((log.bodies[0].poses[0].p - Vector3(0.1, -0.3, 0.2)).norm(), 1e-12);
  EXPECT_LT(angle_between(log.bodies[0].poses[0].pose().R, Matrix3::Identity()), 1e-9);
  EXPECT_LT(angle_between(log.bodies[0].poses[1].pose().R, exp_rotation(Vector3(0, 0, M_PI / 2))), 1e-5);
  Hints hints;
  hints.up = UpAxis::Z;
  const Imported z = read_motive(text, "take.csv", hints);
  EXPECT_LT((z.recording.motion_capture.bodies[0].poses[0].p - Vector3(0.1, 0.2, 0.3)).norm(), 1e-12);
  EXPECT_NE(y.remarks.front().find("Marker"), std::string::npos) << "what is left out is said";
}

TEST(Motive, LostBodiesHaveEmptyCellsOrRowsThatEnd) {
  const std::string text = header("Quaternion", "Meters", kQuaternionColumns) +
                           "0,0.0,0,0,0,1,1,2,3,0.1,5\r\n1,0.01,,,,,,,,,\r\n2,0.02\r\n3,0.03,0,0,0,1,1,2,3,0.1,5\r\n";
  const auto& poses = read_motive(text, "take.csv", {}).recording.motion_capture.bodies.at(0).poses;
  ASSERT_EQ(poses.size(), 4U);
  EXPECT_FALSE(record::is_tracked(poses[1]));
  EXPECT_FALSE(record::is_tracked(poses[2]));
  EXPECT_TRUE(record::is_tracked(poses[3]));
}

TEST(Motive, TablesThatASpreadsheetSavedHaveCommasInEmptyLines) {
  std::string text =
      header("Quaternion", "Meters", kQuaternionColumns) + "0,0,0,0,0,1,1,2,3,,\n1,0.008,0,0,0,0.999945,1,2,3,,\n";
  text.replace(text.find("Global\r\n\r\n"), 10, "Global,,,,\r\n,,,,,,,,,,\r\n");
  EXPECT_EQ(read_motive(text, "take.csv", {}).recording.motion_capture.bodies.at(0).poses.size(), 2U);
}

TEST(Motive, AnglesTurnInTheirOrderAboutTheTurnedAxes) {
  const std::string columns =
      ",,,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n"  // as older versions, with a time code
      ",,,Base,Base,Base,Base,Base,Base\n,,,1,1,1,1,1,1\n"
      ",,,Rotation,Rotation,Rotation,Position,Position,Position\n"
      "Frame,Time (Seconds),TimeCode,X,Y,Z,X,Y,Z\n";
  const std::string rows = "0,0,a,30,40,50,1,2,3\n1,0.1,b,30,40,50,1,2,3\n";
  const double d = M_PI / 180.0;
  const Matrix3 Rx = exp_rotation(30 * d * Vector3::UnitX()), Ry = exp_rotation(40 * d * Vector3::UnitY()),
                Rz = exp_rotation(50 * d * Vector3::UnitZ());
  Hints hints;
  hints.up = UpAxis::Z;
  const auto read = [&](const std::string& order) {
    return read_motive(header(order, "Centimeters", columns) + rows, "take.csv", hints)
        .recording.motion_capture.bodies.at(0)
        .poses.at(0);
  };
  EXPECT_LT(angle_between(read("XYZ").pose().R, Rx * Ry * Rz), 1e-9);
  EXPECT_LT(angle_between(read("ZXY").pose().R, Rz * Rx * Ry), 1e-9);
  EXPECT_LT((read("YZX").p - Vector3(0.01, 0.02, 0.03)).norm(), 1e-12);
}

/// Of a spreadsheet, or of an early version: a header that ends before the units.
std::string short_header(const std::string& columns) {
  return "Format Version,1.22,Take Name,A take,,,,\n,,,,\n" + columns;
}

const std::string kAngleColumns =
    ",,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Marker\n"
    ",,Base,Base,Base,Base,Base,Base,Unlabeled 1004\n,,1,1,1,1,1,1,\n"
    ",,Rotation,Rotation,Rotation,Position,Position,Position,Position\n"
    "Frame,Time (Seconds),X,Y,Z,X,Y,Z,X\n0,0,30,40,50,1,2,3,\n1,0.1,30,40,50,1,2,3,7\n";

TEST(Motive, WhatAShortHeaderDoesNotSayIsAskedFor) {
  expect_refusal([] { return read_motive(short_header(kAngleColumns), "take.csv", {}); }, "--length-unit");
  Hints hints;
  hints.length_unit = "cm";
  expect_refusal([&] { return read_motive(short_header(kAngleColumns), "take.csv", hints); }, "--rotation XYZ");
  hints.rotation = "XYZ";
  const Imported said = read_motive(short_header(kAngleColumns), "take.csv", hints);
  const Imported written = read_motive(header("XYZ", "Centimeters", kAngleColumns), "take.csv", {});
  EXPECT_EQ(said.recording.motion_capture, written.recording.motion_capture);
  // Four numbers need no order.
  const Imported four =
      read_motive(short_header(kQuaternionColumns) + "0,0,0,0,0,1,1,2,3,,\n1,1,0,0,0,1,1,2,3,,\n", "take.csv", hints);
  EXPECT_LT((four.recording.motion_capture.bodies.at(0).poses[0].p - Vector3(0.01, -0.03, 0.02)).norm(), 1e-12);
}

TEST(Motive, WhatTheHeaderSaysIsNotOverruled) {
  const std::string text = header("XYZ", "Centimeters", kAngleColumns);
  Hints hints;
  hints.length_unit = "mm";
  expect_refusal([&] { return read_motive(text, "take.csv", hints); }, "'cm', as the header says");
  hints.length_unit = "cm";
  hints.rotation = "ZYX";
  expect_refusal([&] { return read_motive(text, "take.csv", hints); }, "'XYZ', as the header says");
  hints.rotation = "XYZ";
  EXPECT_EQ(read_motive(text, "take.csv", hints).recording, read_motive(text, "take.csv", {}).recording);
}

TEST(Motive, MutantsAreReadOrRefused) {
  const std::vector<std::string> words = {"1e999", "-1", "", ",", "\n", "\"", "nan", "Rigid Body", "Frame", "\xff"};
  Hints hints;
  hints.length_unit = "cm";
  hints.rotation = "XYZ";
  const auto read = [&](const std::string& text) { (void)read_motive(text, "take.csv", hints); };
  EXPECT_GT(test::expect_answers(short_header(kAngleColumns), words, 2500, read), 0);
  const std::string quaternions = short_header(kQuaternionColumns) + "0,0,0,0,0,1,1,2,3,,\n1,1,,,,,,,,,\n2,2\n";
  EXPECT_GT(test::expect_answers(quaternions, words, 2500, read), 0);
}

TEST(Motive, SlipsAreRefusedWithLineAndCause) {
  const std::string good = header("Quaternion", "Meters", kQuaternionColumns);
  const std::string row = "0,0.0,0,0,0,1,1,2,3,0.1,5\n";
  const struct {
    std::string text, part;
  } slips[] = {
      {good, "no row"},
      {good + row, "one row"},
      {good + row + row, "take.csv:9: time"},
      {good + row + "1,0.1,0,0,0,0.5,1,2,3,0.1,5\n", "length 0.5"},
      {good + row + "1,0.1,0,0,0,1,1,,3,0.1,5\n", "some of a pose"},
      {good + row + "1,0.1,0,0,0,1,1,x,3,0.1,5\n", "'x'"},
      {good + row + "1,0.1,0,0,0,1,1,2e5,3,0.1,5\n", "is the unit"},
      {good + row + "1,0.1,0,0,0,1,1,2,3,0.1,5,6\n", "12 cells"},
      {good + row + ",,0,0,0,1,1,2,3,0.1,5\n", "time"},
      {header("Quaternion", "Furlongs", kQuaternionColumns) + row, "Meters, Centimeters"},
      {header("Sideways", "Meters", kQuaternionColumns) + row, "'XYZ'"},
      {"Format Version,1.0\n" + row, "Length Units"},
      {short_header(",,Rigid Body\n,,A\n,,Rotation\nFrame,Time,X\n0,0,1\n"), "Length Units"},
      {header("Quaternion", "Meters", "") + row, "no line that begins with Frame"},
      {header("Quaternion", "Meters", ",Type,Marker\n,Name,M\n,,Position\nFrame,Time (Seconds),X\n0,0,1\n"),
       "no rigid body, but 1 columns of kind 'Marker'"},
      {header("Quaternion", "Meters", ",Type\n,Name\n,ID\n,\nFrame,Time (Seconds)\n0,0\n"), "times alone"},
      {"Format Version;1.23;Length Units;Meters\n", "semicolons"},
      {header("Quaternion", "Meters", ",Type,Rigid Body\n,Name,M\n,,Position\nFrame,Time (Seconds),X\n0,0,1\n"),
       "lacks columns"},
  };
  for (const auto& slip : slips) {
    SCOPED_TRACE(slip.part);
    expect_refusal([&] { return read_motive(slip.text, "take.csv", {}); }, slip.part);
  }
}

}  // namespace
}  // namespace snug::archive_import::internal
