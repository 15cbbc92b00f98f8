// Files of others, if SNUG_MEASUREMENTS_FOLDER names a folder of them: what each becomes, against numbers that were
// read from it by another program, or why it is refused. docs/build.md says which files and where they are from.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>

#include "refusals.hpp"
#include "snug/archive_import/measurements.hpp"

namespace snug::archive_import {
namespace {

namespace fs = std::filesystem;
using record::PoseSample;
using test::expect_refusal;

class PublicFiles : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("SNUG_MEASUREMENTS_FOLDER") == nullptr)
      GTEST_SKIP() << "SNUG_MEASUREMENTS_FOLDER does not name a folder of public measurements";
  }
};

/// The file in the folder, as REPOSITORY/PATH; nothing, and a line, where it is not there.
std::optional<fs::path> find_public(const std::string& name) {
  const char* folder = std::getenv("SNUG_MEASUREMENTS_FOLDER");
  if (folder == nullptr || *folder == '\0') return std::nullopt;
  const fs::path path = fs::path(folder) / name;
  if (fs::exists(path)) return path;
  std::cout << "public_files_test: no " << name << " in SNUG_MEASUREMENTS_FOLDER\n";
  return std::nullopt;
}

/// What it becomes, read once; nothing where it is not there, or is a bag and the Python has no reader.
const Imported* read_public(const std::string& name, const Hints& hints) {
  static std::map<std::string, std::optional<Imported>> read;
  const auto [found, is_new] = read.try_emplace(name);
  if (is_new) {
    try {
      if (const auto path = find_public(name)) found->second = load(*path, hints);
    } catch (const InputError& error) {
      if (std::string(error.what()).find("no reader") == std::string::npos) throw;
      std::cout << "public_files_test: " << error.what() << '\n';
    }
  }
  return found->second ? &*found->second : nullptr;
}

/// Position [m], quaternion w, x, y, z.
using Seven = std::array<double, 7>;

void expect_pose(const PoseSample& pose, const Seven& expected) {
  ASSERT_TRUE(record::is_tracked(pose));
  EXPECT_LT((pose.p - Vector3(expected[0], expected[1], expected[2])).norm(), 1e-9);
  const Quaternion quat(expected[3], expected[4], expected[5], expected[6]);
  const double sign = pose.quat.dot(quat) < 0.0 ? -1.0 : 1.0;
  EXPECT_LT((sign * pose.quat.coeffs() - quat.coeffs()).norm(), 1e-9);
}

/// What is tracked of a body, or of the tool where `body` is empty.
std::vector<PoseSample> tracked(const record::ArchiveRecording& recording, const std::string& body) {
  std::vector<PoseSample> poses = recording.robot.tool;
  for (const record::BodyTrack& track : recording.motion_capture.bodies)
    if (track.name == body) poses = track.poses;
  std::erase_if(poses, [](const PoseSample& pose) { return !record::is_tracked(pose); });
  return poses;
}

struct PublicPose {
  std::string file, body;
  Hints hints;
  std::size_t rows, poses;
  Seven first, last;
};

Hints of_rate(double rate) {
  Hints hints;
  hints.rate = rate;
  return hints;
}

Hints of_angles(const std::string& unit, const std::string& order) {
  Hints hints;
  hints.length_unit = unit;
  hints.rotation = order;
  return hints;
}

TEST_F(PublicFiles, PosesAreThoseOfAnotherProgram) {
  // One bag, plain and in two compressions.
  const Seven turtle_first{5.544444561005, 5.544444561005, 0, 1, 0, 0, 0};
  const Seven turtle_last{0.9977187514305, 0.7498267292976, 0, 0.5062202901309, 0, 0, 0.8624042079326};
  const PublicPose files[] = {
      {"pool-experiment/optitrack.csv",
       "Right Hand",
       {},
       3856,
       3856,
       {-0.563813782, -0.992204224, 0.4424888, 0.06998700035536, -0.4082100020727, 0.7151700036313, 0.5630260028588},
       {-0.400415955, -1.969953491, 0.446843109, 0.3418699104863, 0.03227899154822, 0.7870087939332, 0.5125428657981}},
      {"pool-experiment/optitrack.csv",
       "Right Forearm",
       {},
       3856,
       3856,
       {-0.263975159, -2.481029541, 0.628341919, 0.1112630047771, 0.761988032716, -0.09997600429247, -0.6300790270524},
       {-0.263975159, -2.481029541, 0.628341919, 0.1112630047771, 0.761988032716, -0.09997600429247, -0.6300790270524}},
      {"pool-experiment/optitrack.csv",
       "Right Upper Arm",
       {},
       3856,
       3856,
       {-0.401939362, -2.395030029, 0.701514221, 0.7052679345592, -0.4861849548876, -0.505417953103, -0.1037979903687},
       {-0.401939362, -2.395030029, 0.701514221, 0.7052679345592, -0.4861849548876, -0.505417953103, -0.1037979903687}},
      {"pool-experiment/optitrack.csv",
       "Cue Stick",
       {},
       3856,
       3856,
       {0.499776703, -0.650386536, 0.362318481, 0.7282852436701, -0.6603022209243, -0.1384110463096, 0.1201830402109},
       {0.134985611, -1.320442383, 0.027743734, 0.6611030126162, -0.2721020051927, -0.270232005157, 0.6448860123067}},
      {"pool-experiment/optitrack.csv",
       "Cue Ball 1",
       {},
       3856,
       3856,
       {-0.641090515, -0.977893799, 0.558346741, 0.07977100101293, -0.4298570054583, 0.8400670106672, 0.3211650040782},
       {1.304074219, -1.352643311, -0.574482483, 0.09165800485054, 0.07203400381204, 0.8897660470864,
        -0.4412780233524}},
      {"hmv-s16/python/rhinoscripts/sample_optitrack_take.csv",
       "Rigid Body 1",
       {},
       250,
       250,
       {0.060002, -0.076611, 0.01915, 0.9999999988095, -3.499999995832e-05, -2.999999996429e-05, -1.599999998095e-05},
       {0.060349, -0.076408, 0.019146, 0.9999999870595, 4.099999946938e-05, 2.199999971531e-05, 0.0001539999980072}},
      {"rigid-body-motion/tests/test_data/optitrack.csv",
       "RigidBody 01",
       of_angles("cm", "XYZ"),
       227,
       227,
       {-0.10650912, 0.27749178, 1.55687256, 0.9648845447772, -0.04459218839339, -0.00620409297701, 0.2587872895155},
       {-0.10656032, 0.27190845, 1.55813583, 0.9630622966085, -0.03909406908992, -0.006663784547987, 0.2663423747522}},
      {"rigid-body-motion/tests/test_data/optitrack.csv",
       "RigidBody 02",
       of_angles("cm", "XYZ"),
       227,
       227,
       {0.01707759, -1.74712875, 1.55829163, 0.9999627202776, -0.0004981722718216, -0.003095740287189,
        0.008045263912064},
       {0.01708827, -1.74709091, 1.55830688, 0.9999629974228, -0.0004928602448052, -0.003093114311094,
        0.008012085733452}},
      {"Bachelor_Lego/UR/robot_data.csv",
       "",
       {},
       1736,
       1736,
       {-0.579848, -0.051094, 0.058608, 0.0133718820383, -0.4695102908554, -0.8827634782202, -0.01048432507079},
       {-0.579836, -0.051082, 0.058594, 0.01335816670297, -0.4695149092045, -0.8827610016321, -0.0105034953444}},
      {"GUI-RTDE/robot_data.csv",
       "",
       {},
       11,
       11,
       {0.047376314703, -0.347332476031, 0.35249275725, 0.02250544837695, 0.2238464506151, 0.9688175549463,
        -0.1038210795951},
       {0.047376314703, -0.347332476031, 0.35249275725, 0.02250544837695, 0.2238464506151, 0.9688175549463,
        -0.1038210795951}},
      {"bachelorproject/Testdaten/kurve_c1/robot_c1.csv",
       "",
       of_rate(125.0),
       1665,
       1665,
       {-0.3112256824359, 0.09853215008098, 0.07888479147011, 0.3449373578192, 0.9095021889267, -0.003848539923356,
        0.2319680500817},
       {0.08853147530143, 0.3296274678469, 0.5536652935219, 0.1518726003653, 0.7283550015627, -0.6653955281655,
        -0.06068357318333}},
      {"evo/test/data/ROS_example.bag",
       "groundtruth",
       {},
       12765,
       12765,
       {-0.004899939787715, -0.01775981455685, -0.01375531840677, 0.9999926388911, -0.003686294937051,
        -7.802442831384e-05, 0.001061746400889},
       {-3.32159756572, -4.640516510389, 32.78393290025, 0.9970778142258, -0.003503691824402, -0.07604175738362,
        -0.00641931899877}},
      {"evo/test/data/ROS_example.bag",
       "ORB-SLAM",
       {},
       12765,
       11147,
       {-2.187487094871e-05, 5.071336124348e-05, 1.094563472494e-04, 0.9999999992013, 3.19631669182e-05,
        7.481788606334e-06, -2.279990367226e-05},
       {-7.632179924735, 1.917204565418, -15.22619003461, 0.9493669011542, -0.004868068611609, 0.3056551325666,
        0.07248261058063}},
      {"evo/test/data/ROS_example.bag",
       "S-PTAM",
       {},
       12765,
       11150,
       {-1.590431223738e-04, 4.076550903668e-04, 3.878585692583e-04, 0.9999999894377, 1.26968758038e-04,
        6.804147046663e-05, -1.933756709287e-05},
       {-10.95180156351, -5.882498049595, -24.73826808758, 0.9360903569062, 4.889537198265e-04, 0.3492169988395,
        0.04221483569902}},
      {"RobLab_hw4/rosbag",
       "pose",
       {},
       1203,
       1203,
       {-3.65346820827e-12, -0.02000000000004, 0, 0.9996907574912, 0, 0, 0.02486743627249},
       {0.4707191625229, 2.996196640435, 0, 0.7488345275284, 0, 0, 0.6627570070405}},
      {"evo/test/data/tf_example",
       "base_footprint",
       {},
       517,
       517,
       {1.160379688715, -2.942426888389, 0, 0.732465690561, 0, 0, 0.6808039454578},
       {0.4409785886185, -0.1300152062732, 0, 0.9996567762677, 0, 0, -0.02619789422922}},
      {"evo/test/data/nav2_turtlebot.mcap",
       "base_link",
       {},
       2502,
       2502,
       {4.365196653968, 7.579351695735, 0, 0.9960720972506, 0, 0, 0.0885459037948},
       {7.196878101977, 7.785064163973, 0, 0.9936223145994, 0, 0, -0.1127594604905}},
      {"rosbag/fixtures/example.bag", "turtle1", {}, 1344, 1344, turtle_first, turtle_last},
      {"rosbag/fixtures/example-bz2.bag", "turtle1", {}, 1344, 1344, turtle_first, turtle_last},
      {"rosbag/fixtures/example-lz4.bag", "turtle1", {}, 1344, 1344, turtle_first, turtle_last},
      {"rigid-body-motion/tests/test_data/test.bag",
       "t265_tracker",
       {},
       57,
       57,
       {-1.027548487479, 1.356312360541, 0.8057809045368, 0.3934160755187, -0.04762464788887, 0.1305119210045,
        -0.9088026864577},
       {-1.03106718401, 1.354407919745, 0.801965008764, 0.3929715709695, -0.03884751680286, 0.1338859494868,
        -0.9089217608672}},
  };
  for (const PublicPose& file : files) {
    SCOPED_TRACE(file.file + " " + file.body);
    const Imported* const imported = read_public(file.file, file.hints);
    if (imported == nullptr) continue;
    const record::ArchiveRecording& recording = imported->recording;
    EXPECT_EQ(file.body.empty() ? recording.robot.times.size() : recording.motion_capture.times.size(), file.rows);
    const std::vector<PoseSample> poses = tracked(recording, file.body);
    EXPECT_EQ(poses.size(), file.poses);
    if (poses.empty()) continue;
    expect_pose(poses.front(), file.first);
    expect_pose(poses.back(), file.last);
  }
}

TEST_F(PublicFiles, JointsAreThoseOfAnotherProgram) {
  const struct {
    std::string file;
    Hints hints;
    std::size_t rows;
    std::vector<double> first, last;  ///< actual_q_0 and on, rad or m
  } files[] = {
      {"GUI-RTDE/robot_data.csv",
       {},
       11,
       {1.3084329994998356, -1.5311321190997251, 1.39087118907581, -1.637036610180001, -1.5187584099703901,
        0.19716306992478466},
       {1.3084329994998356, -1.5311321190997251, 1.39087118907581, -1.637036610180001, -1.5187584099703901,
        0.19716306992478466}},
      {"bachelorproject/Testdaten/kurve_c1/robot_c1.csv",
       of_rate(125.0),
       1665,
       {5.444675445556641, -1.2990859311870118, 1.9172027746783655, 4.947968470841207, -1.4586203734027308,
        -5.591660801564352},
       {3.9429588317871094, -1.5505568546107789, 0.7843835989581507, 5.79017590263442, -1.4586084524737757,
        -5.591636959706442}},
      {"panda_fault_injection_block/plot_bags/real_joint_states_2023-03-21-23-05-07.bag",
       {},
       4211,
       {0.0035819665089995567, -0.005518941418798384, -0.004028525326873478, -1.5870935363876766, 0.004098522624479628,
        1.6636410189674917, 0.802368344898583, 0.0037969909520597644, 0.0037969909520597644},
       {0.003581966509005774, -0.005518941418778844, -0.004028525326878807, -1.587093536387689, 0.004098522624424561,
        1.6636410189674322, 0.8023683448982846, 0.0037887520067760292, 0.0037887520067760292}},
      {"ObjectTrackingDataset/joint_states.bag",
       {},
       988,
       {-0.07160813379706181, -0.3516749505217881, 0.05025743297217539, -2.2770437935259604, -0.12251094895601271,
        1.8823762522608833, 0.9424180180877446, 0.0, 0.0},
       {-0.07160990946088486, -0.35167498615962023, 0.05026088965566994, -2.277044082438558, -0.12250972825288771,
        1.8823786089290646, 0.9424187301645676, 0.0, 0.0}},
  };
  for (const auto& file : files) {
    SCOPED_TRACE(file.file);
    const Imported* const imported = read_public(file.file, file.hints);
    if (imported == nullptr) continue;
    const record::RobotLog& robot = imported->recording.robot;
    EXPECT_EQ(robot.times.size(), file.rows);
    for (std::size_t i = 0; i < file.first.size(); ++i) {
      const auto found = std::find(robot.names.begin(), robot.names.end(), "actual_q_" + std::to_string(i));
      EXPECT_NE(found, robot.names.end());
      if (found == robot.names.end()) continue;
      const auto& column = robot.columns[static_cast<std::size_t>(found - robot.names.begin())];
      EXPECT_EQ(column.front(), file.first[i]);
      EXPECT_EQ(column.back(), file.last[i]);
    }
  }
}

TEST_F(PublicFiles, WhatIsRefusedIsToldWhy) {
  const struct {
    std::string file, part;
  } files[] = {
      {"rigid-body-motion/tests/test_data/optitrack.csv", "--length-unit"},
      {"optitrack-motive-file-converter/test_data/test_default.csv", "times alone"},
      {"optitrack-motive-file-converter/test_data/test_markers_enabled.csv", "54 columns of kind 'Marker'"},
      {"mocap/python/testData/v1.1.csv", "Motive before 1.2"},
      {"optitrack_benchmarking_utils/hloc/optitrack_data.csv", "no names of columns"},
      {"AP-mocap-data-viz/moTrail/defaultData.csv", "begins with 'x', 'y', 'z'"},
      {"bachelorproject/Testdaten/kurve_c1/robot_c1.csv", "--rate HZ"},
      {"100638182-Cobot-Client-App/robot_data.csv", "one row of numbers"},
      {"Robotic_Arm_6DOF/ROS2/rosbag2", "/display_planned_path (moveit_msgs/DisplayTrajectory)"},
      {"Robotic_Arm_6DOF/ROS2/rosbag2/rosbag2.mcap", "/display_planned_path (moveit_msgs/DisplayTrajectory)"},
      {"rosbag2/rosbag2_py/test/resources/mcap/talker/talker.mcap", "/topic (std_msgs/String)"},
      {"rosbag2/rosbag2_py/test/resources/sqlite3/talker/talker.db3", "rcl_interfaces/ParameterEvent, std_msgs/String"},
  };
  for (const auto& file : files) {
    SCOPED_TRACE(file.file);
    const auto path = find_public(file.file);
    if (!path) continue;
    try {
      (void)load(*path, {});
      ADD_FAILURE() << "was read, without: " << file.part;
    } catch (const InputError& error) {
      const std::string said = error.what();
      if (said.find("no reader") != std::string::npos) continue;
      EXPECT_NE(said.find(file.part), std::string::npos) << said;
    }
  }
}

}  // namespace
}  // namespace snug::archive_import
