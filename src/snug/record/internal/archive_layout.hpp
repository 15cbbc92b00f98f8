// Archive layout: the paths inside an archive and the rules that its contents keep; reader and writer both use them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "snug/record/archive.hpp"

namespace snug::record::internal {

inline constexpr const char* kSensorGroup = "SENSOR_MEASUREMENT";
inline constexpr const char* kObjectGroup = "OBJECT";
inline constexpr const char* kForceGroup = "SENSOR_MEASUREMENT/ft_data/datalog";
inline constexpr const char* kMocapTable = "SENSOR_MEASUREMENT/Mocap/datalog";
inline constexpr const char* kMocapBodies = "SENSOR_MEASUREMENT/Mocap/POSTPROCESSING";
inline constexpr const char* kRobotTable = "SENSOR_MEASUREMENT/UR10_sensor/datalog";
inline constexpr const char* kRobotTool = "SENSOR_MEASUREMENT/UR10_sensor/POSTPROCESSING/TCP";
inline constexpr const char* kTimeColumn = "Time(s)";

/// Instants of a chunk of poses: about 10 s of motion capture.
inline constexpr std::size_t kPoseChunk = 3600;
/// Largest entry of R^T R - I that a stored rotation may have: single precision gives 1e-6, files printed with four
/// digits 2e-4.
inline constexpr double kRotationTolerance = 1e-3;

/// Says what is wrong and where: `part` is the path behind the recording's name.
using Complain = std::function<void(const std::string& part, const std::string& got, const std::string& expected)>;

/// Complains unless times are finite and grow and, when `frequency` is given, fit it.
void require_times(const std::vector<double>& times, const std::string& part, const Complain& complain);
/// Complains unless motion capture's times have this rate, within 5 %.
void require_frequency(const std::vector<double>& times, double frequency, const std::string& part,
                       const Complain& complain);
/// Complains about a length that is not that of the times.
void require_length(std::size_t length, std::size_t times, const std::string& part, const Complain& complain);

}  // namespace snug::record::internal
