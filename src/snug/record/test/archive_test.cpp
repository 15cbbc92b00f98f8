// Archives come back as they were written, and what is wrong with one is said with its path and index.
#include "snug/record/archive.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <array>
#include <fstream>
#include <functional>

#include "random_recording.hpp"
#include "snug/core/input_error.hpp"

namespace snug::record {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

constexpr const char* kRec = "Rec_20230511T093000Z";
constexpr const char* kMocap = "Rec_20230511T093000Z/SENSOR_MEASUREMENT/Mocap/";
constexpr const char* kForce = "Rec_20230511T093000Z/SENSOR_MEASUREMENT/ft_data/datalog/";

ArchiveRecording example(std::size_t samples = 40) {
  Rng rng = Rng(3).split("archive");
  ArchiveRecording recording;
  recording.name = kRec;
  recording.remarks = {{"note", "first of three"}, {"sequence", "1"}};
  MotionCaptureLog& mocap = recording.motion_capture;
  mocap.sample_frequency = 360.0;
  for (std::size_t i = 0; i < samples; ++i) mocap.times.push_back(2.0 + static_cast<double>(i) / 360.0);
  for (const char* name : {"Base005", "Box013"}) {
    BodyTrack track{name, {}};
    for (std::size_t i = 0; i < samples; ++i) track.poses.push_back(test::random_pose(rng));
    mocap.bodies.push_back(track);
  }
  mocap.bodies[1].poses[3] = lost_pose();
  for (std::size_t i = 0; i < 50; ++i) {
    recording.force_torque.times.push_back(0.002 * static_cast<double>(i));
    recording.force_torque.wrenches.push_back({test::random_vector(rng, 50.0), test::random_vector(rng, 5.0)});
    recording.force_torque.accelerations.push_back(test::random_vector(rng, 9.0));
  }
  RobotLog& robot = recording.robot;
  robot.names = {"actual_q_0", "actual_qd_0"};
  robot.columns.resize(2);
  for (std::size_t i = 0; i < 12; ++i) {
    robot.times.push_back(0.008 * static_cast<double>(i));
    for (auto& column : robot.columns) column.push_back(rng.uniform(-3.0, 3.0));
    robot.tool.push_back(test::random_pose(rng));
  }
  ArchiveObject box{"Box013", 0.55, Vector3(0.2, 0.2, 0.1), Vector3(1e-3, 2e-3, 3e-3).asDiagonal(), {}};
  box.vertices = {Vector3(0.1, 0.1, 0.05), Vector3(-0.1, 0.1, 0.05)};
  recording.objects = {box};
  return recording;
}

/// Poses are kept in single precision: 1e-7 of 2 m, and of a rotation's entries.
void expect_same_poses(const std::vector<PoseSample>& a, const std::vector<PoseSample>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    SCOPED_TRACE(i);
    ASSERT_EQ(is_tracked(a[i]), is_tracked(b[i]));
    if (!is_tracked(a[i])) continue;
    EXPECT_LT((a[i].p - b[i].p).norm(), 5e-7);
    EXPECT_LT(a[i].quat.angularDistance(b[i].quat), 1e-6);
  }
}

TEST(Archive, ComesBackAsItWasWritten) {
  const ScratchFolder folder;
  ArchiveRecording second = example();
  second.name = "Rec_20230511T095000Z";
  save_archive(folder / "a.h5", {{example(), second}});
  const Archive read = load_archive(folder / "a.h5");
  ASSERT_EQ(read.recordings.size(), 2U);
  const ArchiveRecording& a = read.recordings[0];
  const ArchiveRecording b = example();
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(find_remark(a, "note"), "first of three");
  EXPECT_EQ(find_remark(a, "sequence"), "1");
  EXPECT_EQ(a.motion_capture.times, b.motion_capture.times);
  EXPECT_EQ(a.motion_capture.sample_frequency, 360.0);
  ASSERT_EQ(a.motion_capture.bodies.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
    expect_same_poses(a.motion_capture.bodies[i].poses, b.motion_capture.bodies[i].poses);
  EXPECT_EQ(a.force_torque, b.force_torque);
  EXPECT_EQ(a.robot.times, b.robot.times);
  EXPECT_EQ(a.robot.names, b.robot.names);
  EXPECT_EQ(a.robot.columns, b.robot.columns);
  expect_same_poses(a.robot.tool, b.robot.tool);
  EXPECT_EQ(a.objects, b.objects);
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Archive, HasTheSameBytesWhenWrittenAgain) {
  const ScratchFolder folder;
  save_archive(folder / "a.h5", {{example()}});
  save_archive(folder / "b.h5", {{example()}});
  EXPECT_EQ(bytes_of(folder / "a.h5"), bytes_of(folder / "b.h5"));
}

TEST(Archive, LongLossesTakeNoSpaceAndComeBackAsLost) {
  const ScratchFolder folder;
  ArchiveRecording recording = example(3 * 3600);
  for (std::size_t i = 3600; i < 7200; ++i) recording.motion_capture.bodies[1].poses[i] = lost_pose();
  save_archive(folder / "a.h5", {{recording}});
  EXPECT_LT(fs::file_size(folder / "a.h5"), 5U * 3600U * 64U + 300'000U);
  expect_same_poses(load_archive(folder / "a.h5").recordings[0].motion_capture.bodies[1].poses,
                    recording.motion_capture.bodies[1].poses);
}

TEST(Archive, NamesBoxesAsTheDemonstratorDoes) {
  EXPECT_EQ(archive_name("BOX013"), "Box013");
  EXPECT_EQ(archive_name("BOXES"), "BOXES");
  EXPECT_EQ(archive_name("kitchen-1"), "kitchen-1");
  EXPECT_TRUE(is_same_body("BOX013", "Box013"));
  EXPECT_FALSE(is_same_body("BOX013", "Box01"));
}

/// Writes the example, lets `spoil` change the open file, and tells what the reader says then.
std::string complaint(const std::function<void(hid_t)>& spoil) {
  const ScratchFolder folder;
  save_archive(folder / "a.h5", {{example()}});
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  spoil(file);
  H5Fclose(file);
  try {
    (void)load_archive(folder / "a.h5");
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find((folder / "a.h5").string()), 0U) << text;
    return text.substr((folder / "a.h5").string().size());
  }
  return "no complaint";
}

/// Replaces a dataset by one of other dimensions or values.
void replace(hid_t file, const std::string& path, const std::vector<hsize_t>& dims, const std::vector<double>& values) {
  ASSERT_GE(H5Ldelete(file, path.c_str(), H5P_DEFAULT), 0);
  const hid_t space = H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr);
  const hid_t set = H5Dcreate2(file, path.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dclose(set);
  H5Sclose(space);
}

/// Sets one number of a dataset, counted in its order in the file.
void set_number(hid_t file, const std::string& path, std::size_t index, double value) {
  const hid_t set = H5Dopen2(file, path.c_str(), H5P_DEFAULT);
  const hid_t space = H5Dget_space(set);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  values.at(index) = value;
  H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Sclose(space);
  H5Dclose(set);
}

void expect_says(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
}

TEST(ArchiveReader, RefusesTimeThatRunsBackWithItsIndex) {
  const std::string force = complaint([](hid_t f) { set_number(f, std::string(kForce) + "time", 7, 0.001); });
  expect_says(force, {"ft_data/datalog/time", "at index 7 after", "times that grow"});
  const std::string nan = complaint([](hid_t f) { set_number(f, std::string(kForce) + "time", 9, NAN); });
  expect_says(nan, {"ft_data/datalog/time", "no number at index 9"});
}

TEST(ArchiveReader, RefusesValuesThatAreNoNumbers) {
  const std::string text = complaint([](hid_t f) { set_number(f, std::string(kForce) + "wrench", 2 * 50 + 3, NAN); });
  expect_says(text, {"ft_data/datalog/wrench", "index 3"});
}

TEST(ArchiveReader, RefusesMatricesThatAreNoRotations) {
  const std::string path = std::string(kMocap) + "POSTPROCESSING/Base005/transforms";
  expect_says(complaint([&](hid_t f) { set_number(f, path, 4, 3.0); }),
              {"Base005/transforms", "index 4", "a rotation"});
  expect_says(complaint([&](hid_t f) {
                for (std::size_t k = 0; k < 3; ++k)  // mirrors the x axis at instant 2
                  set_number(f, path, (4 * k) * 40 + 2, k == 0 ? -1.0 : 0.0);
                for (std::size_t k = 0; k < 9; ++k)
                  if (k % 3 != 0) set_number(f, path, (4 * (k / 3) + k % 3) * 40 + 2, k / 3 == k % 3 ? 1.0 : 0.0);
              }),
              {"a mirror image at index 2"});
  expect_says(complaint([&](hid_t f) { set_number(f, path, 15 * 40 + 6, 0.0); }), {"index 6", "0 0 0 1"});
  expect_says(complaint([&](hid_t f) { set_number(f, path, 3 * 40 + 8, NAN); }), {"index 8", "all 16 numbers"});
  expect_says(complaint([&](hid_t f) { set_number(f, path, 3 * 40 + 8, 1350.0); }), {"index 8", "metres"});
}

TEST(ArchiveReader, ShowsNothingOfOtherFiles) {
  const ScratchFolder folder;
  save_archive(folder / "other.h5", {{example()}});
  const std::string wrench = std::string(kForce) + "wrench", bodies = std::string(kMocap) + "POSTPROCESSING";
  const auto link = [](hid_t file, const std::string& path, const std::string& target, const char* other) {
    ASSERT_GE(H5Ldelete(file, path.c_str(), H5P_DEFAULT), 0);
    if (other == nullptr) {
      ASSERT_GE(H5Lcreate_soft(target.c_str(), file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT), 0);
    } else {
      ASSERT_GE(H5Lcreate_external(other, target.c_str(), file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT), 0);
    }
  };
  const std::string other = (folder / "other.h5").string();
  for (const std::string& path : {wrench, bodies, std::string(kForce).substr(0, std::string(kForce).find('/', 1))}) {
    expect_says(complaint([&](hid_t f) { link(f, path, path, other.c_str()); }), {"is a link to something else"});
  }
  expect_says(complaint([&](hid_t f) { link(f, wrench, std::string("/") + kForce + "time", nullptr); }),
              {"is a link to something else"});
  expect_says(complaint([&](hid_t f) {
                ASSERT_GE(H5Ldelete(f, wrench.c_str(), H5P_DEFAULT), 0);
                const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
                H5Pset_external(properties, other.c_str(), 0, 6 * 50 * 8);
                const hsize_t sides[2] = {6, 50};
                const hid_t space = H5Screate_simple(2, sides, nullptr);
                H5Dclose(H5Dcreate2(f, wrench.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT));
                H5Sclose(space);
                H5Pclose(properties);
              }),
              {"is kept in another file"});
}

TEST(ArchiveReader, RefusesNamesThatAreNoText) {
  const std::string bodies = std::string(kMocap) + "POSTPROCESSING/";
  for (const char* name : {"Box\xe9", "Box\x1b[2J", "Box\n", "\u202exoB"}) {
    const std::string text = complaint([&](hid_t f) {
      ASSERT_GE(H5Lmove(f, (bodies + "Base005").c_str(), f, (bodies + name).c_str(), H5P_DEFAULT, H5P_DEFAULT), 0);
    });
    expect_says(text, {"a name that is not UTF-8, or has control characters"});
  }
}

TEST(ArchiveReader, RefusesOtherShapes) {
  expect_says(complaint([](hid_t f) {
                replace(f, std::string(kForce) + "wrench", {6, 49}, std::vector<double>(294));
              }),
              {"wrench", "got 6x49", "6x50"});
  expect_says(complaint([](hid_t f) {
                replace(f, std::string(kForce) + "wrench", {50, 6}, std::vector<double>(300));
              }),
              {"wrench", "got 50x6", "6x50", "reversed"});
  expect_says(
      complaint([](hid_t f) {
        replace(f, std::string(kMocap) + "POSTPROCESSING/Box013/transforms", {4, 4, 39}, std::vector<double>(624));
      }),
      {"Box013/transforms", "4x4x39", "4x4x40"});
}

TEST(ArchiveReader, RefusesMissingGroupsAndDatasets) {
  const auto without = [](const std::string& path) {
    return complaint([&](hid_t f) { H5Ldelete(f, path.c_str(), H5P_DEFAULT); });
  };
  expect_says(without(std::string(kRec) + "/SENSOR_MEASUREMENT"), {kRec, "SENSOR_MEASUREMENT"});
  expect_says(without(std::string(kMocap) + "POSTPROCESSING"), {"Mocap/POSTPROCESSING", "got nothing", "a group"});
  expect_says(without(std::string(kMocap) + "datalog"), {"Mocap/datalog", "got nothing", "a dataset"});
  expect_says(without(std::string(kForce) + "time"), {"ft_data/datalog/time", "got nothing"});
  expect_says(without(std::string(kRec) + "/OBJECT/Box013/mass"), {"OBJECT/Box013/mass", "got nothing"});
  expect_says(without(kRec), {"no group"});
}

TEST(ArchiveReader, RefusesRatesThatTheTimesDoNotHave) {
  const std::string text = complaint([](hid_t f) {
    const hid_t set = H5Dopen2(f, (std::string(kMocap) + "datalog").c_str(), H5P_DEFAULT);
    const hid_t attribute = H5Aopen(set, "sample_frequency", H5P_DEFAULT);
    const double rate = 120.0;
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, &rate);
    H5Aclose(attribute);
    H5Dclose(set);
  });
  expect_says(text, {"Mocap/datalog", "120.0", "360.0"});
}

TEST(ArchiveReader, RefusesTruncatedFilesAtAnyLength) {
  const ScratchFolder folder;
  save_archive(folder / "a.h5", {{example()}});
  const std::string bytes = bytes_of(folder / "a.h5");
  for (const double share : {0.0, 0.001, 0.05, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999}) {
    SCOPED_TRACE(share);
    const auto size = static_cast<std::size_t>(share * static_cast<double>(bytes.size()));
    std::ofstream(folder / "cut.h5", std::ios::binary) << bytes.substr(0, size);
    EXPECT_THROW((void)load_archive(folder / "cut.h5"), InputError);
  }
}

TEST(ArchiveReader, RefusesCountsThatTheFileCannotHold) {
  const ScratchFolder folder;
  save_archive(folder / "a.h5", {{example()}});
  const std::string path = std::string(kForce) + "time";
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Ldelete(file, path.c_str(), H5P_DEFAULT);
  const std::array<hsize_t, 2> dims{1, hsize_t{1} << 40U}, chunk{1, 1024};
  const hid_t space = H5Screate_simple(2, dims.data(), nullptr), layout = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(layout, 2, chunk.data());
  H5Dclose(H5Dcreate2(file, path.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, layout, H5P_DEFAULT));
  H5Pclose(layout);
  H5Sclose(space);
  H5Fclose(file);
  try {
    (void)load_archive(folder / "a.h5");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.key.find("ft_data/datalog/time"), std::string::npos);
    EXPECT_EQ(error.got, "1x1099511627776");
  }
}

TEST(ArchiveReader, SurvivesChangedBytes) {
  const ScratchFolder folder;
  save_archive(folder / "a.h5", {{example(4)}});  // few samples: most bytes are structure
  const std::string bytes = bytes_of(folder / "a.h5");
  Rng rng = Rng(11).split("changed bytes");
  for (int round = 0; round < 150; ++round) {
    std::string changed = bytes;
    for (int k = 0; k < 8; ++k)
      changed[static_cast<std::size_t>(rng.index(static_cast<int>(bytes.size())))] = static_cast<char>(rng.index(256));
    std::ofstream(folder / "b.h5", std::ios::binary) << changed;
    try {
      (void)load_archive(folder / "b.h5");
    } catch (const InputError&) {  // refused with a message: what is asked for; a crash is not
    }
  }
}

TEST(ArchiveReader, TellsEveryDefectWhenAskedTo) {
  const ScratchFolder folder;
  save_archive(folder / "a.h5", {{example()}});
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  set_number(file, std::string(kForce) + "time", 7, 0.001);
  set_number(file, std::string(kMocap) + "POSTPROCESSING/Base005/transforms", 4, 3.0);
  H5Ldelete(file, (std::string(kRec) + "/OBJECT/Box013/mass").c_str(), H5P_DEFAULT);
  H5Fclose(file);
  const ArchiveReader reader(folder / "a.h5");
  const std::vector<InputError> found = reader.find_defects(0);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_NE(found[0].key.find("ft_data"), std::string::npos);
  EXPECT_NE(found[1].key.find("Base005"), std::string::npos);
  EXPECT_NE(found[2].key.find("OBJECT/Box013/mass"), std::string::npos);
}

TEST(ArchiveReader, PassesOverCamerasAndOtherSourcesThatAreNotRead) {
  const ScratchFolder folder;
  save_archive(folder / "a.h5", {{example()}});
  const ArchiveRecording whole = load_archive(folder / "a.h5").recordings[0];
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t parents = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(parents, 1);
  const auto add = [&](const std::string& path) { H5Gclose(H5Gcreate2(file, path.c_str(), parents, 0, 0)); };
  add(std::string(kRec) + "/SENSOR_MEASUREMENT/Zivid001/datalog");
  add(std::string(kRec) + "/SENSOR_MEASUREMENT/ft_data_3/datalog");
  add(std::string(kRec) + "/ENVIRONMENT");
  add("Cameras/Zivid001");
  add("Rec_20230511T100000Z/SENSOR_MEASUREMENT/Zivid001/datalog");
  add("Rec_20230511T101000Z/SENSOR_MEASUREMENT");
  H5Pclose(parents);
  H5Fclose(file);
  const ArchiveReader reader(folder / "a.h5");
  ASSERT_EQ(reader.size(), 3U);
  const ArchiveRecording again = reader.read(0);
  EXPECT_EQ(again.name, whole.name);
  EXPECT_TRUE(again.remarks == whole.remarks);
  EXPECT_EQ(again.motion_capture.times, whole.motion_capture.times);  // with lost markers, which equal nothing
  EXPECT_TRUE(again.force_torque == whole.force_torque);
  EXPECT_TRUE(again.robot == whole.robot);
  EXPECT_TRUE(again.objects == whole.objects);
  const ArchiveRecording camera = reader.read(1);
  EXPECT_TRUE(camera.force_torque.times.empty() && camera.motion_capture.times.empty() && camera.robot.times.empty());
  EXPECT_THROW((void)reader.read(2), InputError);
}

TEST(ArchiveWriter, LeavesWhatIsThereWhenItFails) {
  const ScratchFolder folder;
  save_archive(folder / "a.h5", {{example()}});
  const std::string before = bytes_of(folder / "a.h5");
  ArchiveRecording wrong = example();
  wrong.force_torque.times[3] = 0.0;
  EXPECT_THROW(save_archive(folder / "a.h5", {{example(), wrong}}), InputError);
  ArchiveRecording backwards = wrong;
  backwards.name = "Rec_2";
  EXPECT_THROW(save_archive(folder / "a.h5", {{example(), backwards}}), InputError);
  EXPECT_EQ(bytes_of(folder / "a.h5"), before);
  EXPECT_EQ(std::distance(fs::directory_iterator((folder / "a.h5").parent_path()), fs::directory_iterator()), 1);
}

TEST(ArchiveWriter, ReplacesNothingButArchives) {
  const ScratchFolder folder;
  std::ofstream(folder / "notes.h5") << "not to be lost";
  EXPECT_THROW(save_archive(folder / "notes.h5", {{example()}}), InputError);
  EXPECT_EQ(bytes_of(folder / "notes.h5"), "not to be lost");
}

TEST(ArchiveWriter, RefusesTwoRecordingsOfOneName) {
  const ScratchFolder folder;
  EXPECT_THROW(save_archive(folder / "a.h5", {{example(), example()}}), InputError);
  EXPECT_FALSE(fs::exists(folder / "a.h5"));
}

}  // namespace
}  // namespace snug::record
