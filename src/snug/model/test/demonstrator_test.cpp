// The shipped demonstrator cell against figures typed again by hand from the report and the controller.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "scenario_text.hpp"

namespace snug::model {
namespace {

using test::demonstrator;

TEST(Demonstrator, HasTheFourTypesAndEighteenBoxesOfTables8And9) {
  const Scenario& s = demonstrator();
  EXPECT_EQ(s.name, "box-demonstrator");
  ASSERT_EQ(s.parcel_types.size(), 4u);
  ASSERT_EQ(s.parcels.size(), 18u);
  std::map<std::string, int> counts;
  double mass = 0.0;
  double litres = 0.0;
  for (const Parcel& parcel : s.parcels) {
    ++counts[parcel.type];
    mass += parcel.inertia.mass;
    litres += 1e3 * parcel.size.prod();
    // Each within 5 mm and 3 % of its type.
    const ParcelType& type = *find_parcel_type(s, parcel.type);
    EXPECT_LE((parcel.size - type.size).cwiseAbs().maxCoeff(), 0.0051) << parcel.id;
    EXPECT_NEAR(parcel.inertia.mass / type.mass, 1.0, 0.03) << parcel.id;
  }
  EXPECT_EQ(counts, (std::map<std::string, int>{{"B1", 4}, {"B2", 6}, {"B3", 4}, {"B4", 4}}));
  EXPECT_NEAR(mass, 2.194 + 1.566 + 4.179 + 3.796, 1e-9);
  EXPECT_NEAR(litres, 15.575 + 8.102 + 11.734 + 15.008, 0.05);
}

TEST(Demonstrator, HasTheMomentsOfTable10AndEstimatedCentresOfMass) {
  const Scenario& s = demonstrator();
  const auto moments = [&](const char* id) -> Vector3 { return find_parcel(s, id)->inertia.inertia.diagonal(); };
  EXPECT_EQ(moments("BOX013"), Vector3(0.00211477, 0.0021974, 0.0038231));
  EXPECT_EQ(moments("BOX019"), Vector3(0.00038184, 0.00036295, 0.00058612));
  EXPECT_EQ(moments("BOX026"), Vector3(0.00596339, 0.00326071, 0.00869884));
  EXPECT_EQ(moments("BOX030"), Vector3(0.00455881, 0.00241266, 0.00653819));
  const std::map<std::string, double> com = {{"B1", -0.032}, {"B2", -0.034}, {"B3", -0.012}, {"B4", -0.027}};
  for (const Parcel& parcel : s.parcels) EXPECT_EQ(parcel.inertia.com, Vector3(0, 0, com.at(parcel.type)));
}

TEST(Demonstrator, HasTheContactParametersOfTable2) {
  const Scenario& s = demonstrator();
  const auto id = [&](const std::string& name) {
    for (std::size_t i = 0; i < s.materials.size(); ++i)
      if (s.materials[i].name == name) return MaterialId{static_cast<int>(i)};
    return MaterialId{-1};
  };
  const auto pair = [&](const char* other) { return find_contact(s, id(other), id("box")).value(); };
  const auto friction_and_restitution = [&](const char* other) {
    return std::pair(pair(other).friction, pair(other).restitution);
  };
  EXPECT_EQ(friction_and_restitution("box"), std::pair(0.2, 0.05));
  EXPECT_EQ(friction_and_restitution("container"), std::pair(0.24, 0.1));
  EXPECT_EQ(friction_and_restitution("workbench"), std::pair(0.15, 0.1));
}

TEST(Demonstrator, HasTheFramesOfEquations17And18) {
  const Scenario& s = demonstrator();
  ASSERT_EQ(s.frames.size(), 3u);
  EXPECT_EQ(s.frames[0].X_WF.p, Vector3(-0.353, -0.418, -0.0355));
  EXPECT_EQ(s.frames[1].X_WF.p, Vector3(0.505, -0.350, -0.282));
  EXPECT_EQ(s.frames[2].X_WF.p, Vector3(-1.76, -0.16, -0.105));
  Matrix3 R_WA;
  R_WA << -0.6428, -0.7660, 0, 0.7660, -0.6428, 0, 0, 0, 1;
  EXPECT_LT((s.frames[0].X_WF.R - R_WA).cwiseAbs().maxCoeff(), 5.1e-5);  // four printed digits
  EXPECT_LT(angle_between(s.frames[0].X_WF.R, exp_rotation({0, 0, 2.269})), 1e-4);
  ASSERT_TRUE(s.aligner.has_value());
  EXPECT_EQ(s.aligner->X_WA, s.frames[0].X_WF);
  EXPECT_EQ(s.aligner->support_height, -0.105);
}

TEST(Demonstrator, HasTheContainerWithItsLongSideAlongWorldY) {
  const Scenario& s = demonstrator();
  EXPECT_EQ(s.target, "tote1");
  const Container& tote = *find_container(s, s.target);
  EXPECT_NEAR(compute_volume(tote), 0.052725, 1e-15);
  const Vector3 low = tote.X_WT * Vector3(-0.5 * tote.inner_size.x(), -0.5 * tote.inner_size.y(), 0.0);
  const Vector3 high = tote.X_WT * Vector3(0.5 * tote.inner_size.x(), 0.5 * tote.inner_size.y(), tote.inner_size.z());
  // The mesh is 369 x 567 x 252 mm inside: interior x .3205 .. .6895, y -.6335 .. -.0665, z -.282 .. -.030.
  EXPECT_LT((low - Vector3(0.3205, -0.6335, -0.282)).cwiseAbs().maxCoeff(), 0.002);
  EXPECT_LT((high - Vector3(0.6895, -0.0665, -0.030)).cwiseAbs().maxCoeff(), 0.0021);
}

TEST(Demonstrator, HasTheSequencesOfTable11WithTheMisprintCorrected) {
  const Scenario& s = demonstrator();
  ASSERT_EQ(s.sequences.size(), 5u);
  for (const Sequence& sequence : s.sequences) {
    std::set<std::string> ids;
    for (const Item& item : sequence.items) ids.insert(item.parcel);
    EXPECT_EQ(ids.size(), 18u) << sequence.name;  // each box once
  }
  const Sequence& second = *find_sequence(s, "2");
  EXPECT_EQ(second.items[13].parcel, "BOX013");
  EXPECT_EQ(second.task_stiffness, 15.0);
  EXPECT_EQ(s.controller.task_stiffness, 10.0);
  const auto turned = [&](const char* name) {
    std::string found;
    for (const Item& item : find_sequence(s, name)->items)
      if (item.up != UpAxis::Z) found += item.parcel.substr(4) + (item.up == UpAxis::X ? "X " : "Y ");
    return found;
  };
  EXPECT_EQ(turned("1"), "14X 15X ");
  EXPECT_EQ(turned("2"), "24X 25X 26X 27X 28X 29X 14X 15X 23X 21X ");
  EXPECT_EQ(turned("3"), "24X 25X 26X 23X 28Y ");
  EXPECT_EQ(turned("4"), "14X 26X 15X ");
  EXPECT_EQ(turned("5"), "26X 14X 23X 24X 25X 15X 27X 29X 30X ");
}

TEST(Demonstrator, HasTheFillingDegreesOfThePackedBoxes) {
  const Scenario& s = demonstrator();
  const std::array<double, 5> percent = {74.22, 66.14, 68.69, 66.70, 66.66};
  const std::array<int, 5> packed = {12, 12, 13, 14, 12};
  for (std::size_t k = 0; k < 5; ++k) {
    const Sequence& sequence = s.sequences[k];
    ASSERT_EQ(sequence.reported.size(), 3U);
    EXPECT_EQ(sequence.reported[0].packed_count, packed[k]);
    std::vector<std::string> ids;
    for (int i = 0; i < packed[k]; ++i) ids.push_back(sequence.items[static_cast<std::size_t>(i)].parcel);
    // Two printed digits.
    EXPECT_NEAR(compute_filling_degree_percent(s, *find_container(s, s.target), ids), percent[k], 0.005);
  }
}

TEST(Demonstrator, HasTheControllersTableInItsOrder) {
  const ControllerParams& c = demonstrator().controller;
  ASSERT_EQ(c.limits.size(), 18u);  // the demonstrator's 16, then two of our own motions
  EXPECT_EQ(c.tick, 0.008);
  EXPECT_EQ(c.vacuum_wait, 0.5);
  EXPECT_EQ(c.limits.front(), (MoveLimits{"PrePick", 0.01, 3.0, 0.35, 2.0, 2.0}));
  EXPECT_EQ(c.limits[1], (MoveLimits{"Box", 0.005, 4.0, 0.6, 1.0, 1.5}));
  EXPECT_EQ(c.limits[11], (MoveLimits{"PrePlace018", 0.005, 0.8, 0.2, 1.0, 1.5}));
  EXPECT_EQ(c.limits[12], (MoveLimits{"home", 0.005, 3.0, 0.5, 1.5, 0.5}));
  EXPECT_EQ(c.limits[14], (MoveLimits{"midpoint", 0.2, 2.0, 0.5, 1.5, 2.0}));
  EXPECT_EQ(c.limits[15], (MoveLimits{"PrePlace017_seq3", 0.005, 0.8, 0.2, 1.0, 1.5}));
  EXPECT_EQ(c.limits[16].prefix, "PlaceSlow");
  EXPECT_EQ(c.limits[17].prefix, "TwistDrag");
  EXPECT_LT(angle_between(c.X_WE_start.R, exp_rotation({0.0, -3.14159, 0.0})), 1e-5);
  ASSERT_EQ(c.correction_layers.size(), 2u);
  EXPECT_EQ(c.correction_layers[0].corrections[2].offset, Vector3(0.030, 0.010, 0.0));
  EXPECT_EQ(c.correction_layers[1].name, "seq2-5");
  for (const CorrectionLayer& layer : c.correction_layers) EXPECT_FALSE(layer.with_phases) << layer.name;
  EXPECT_EQ(c.correction_layers[1].corrections[2].offset, Vector3(0.050, 0.010, 0.0));
}

TEST(Demonstrator, WritesOutTheDefaultsOfTheCupButThePushFoundFromItsPrograms) {
  CupParams cup;
  cup.release_push = 0.7;  // docs/decisions/0040
  EXPECT_EQ(demonstrator().cup, cup);
}

TEST(Demonstrator, PutsEveryBoxOnTheBeltWithoutTouchingAnythingElse) {
  // The loader's own check of bodies that start inside others, with each box of each sequence standing at the aligner.
  const Scenario& s = demonstrator();
  std::set<std::string> tried;
  for (const Sequence& sequence : s.sequences)
    for (const Item& item : sequence.items)
      for (int quarter = 0; quarter < 4; ++quarter) {
        if (!tried.insert(item.parcel + std::to_string(static_cast<int>(item.up)) + std::to_string(quarter)).second)
          continue;
        const Matrix3 R_AP = standing_rotation(item.up, item.up_sign, quarter * 1.5707963267948966);
        const Pose X_WP = standing_pose(*s.aligner, find_parcel(s, item.parcel)->size, R_AP);
        const Quaternion quat(X_WP.R);
        std::ostringstream body;
        body.precision(17);
        body << "bodies:\n  - {name: tried, parcel: " << item.parcel << ", pose: {position: [" << X_WP.p.x() << ", "
             << X_WP.p.y() << ", " << X_WP.p.z() << "], quat_wxyz: [" << quat.w() << ", " << quat.x() << ", "
             << quat.y() << ", " << quat.z() << "]}}\n";
        EXPECT_NO_THROW((void)parse_scenario(test::replaced(s.source_text, "\nbodies:\n", "\n" + body.str()), "tried"))
            << item.parcel;
        // And the whole bottom face is over the belt.
        const Body& belt = *find_body(s, "conveyor");
        const Vector3 half_W = 0.5 * (X_WP.R.cwiseAbs() * find_parcel(s, item.parcel)->size);
        const Vector3 room =
            std::get<geometry::Box>(belt.shapes[0].shape).half - half_W - (X_WP.p - belt.X_WB.p).cwiseAbs();
        EXPECT_GT(std::min(room.x(), room.y()), 0.0) << item.parcel;
      }
}

}  // namespace
}  // namespace snug::model
