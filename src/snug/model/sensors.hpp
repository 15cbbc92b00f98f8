// Sensors: what an experiment is measured with: rates, noise, errors, losses and clocks.
#pragma once

#include <filesystem>
#include <string_view>

#include "snug/core/field.hpp"

namespace snug::model {

/// How far a source's clock may be off. What it is off by is drawn for each repetition.
struct ClockParams {
  double offset = 0.0;    ///< s: the clock starts up to this much early or late
  double rate_ppm = 0.0;  ///< 1e-6: it runs up to this much fast or slow

  template <class Archive>
  void fields(Archive& a) {
    a("offset", offset, Range::NotNegative);
    a("rate_ppm", rate_ppm, Range::NotNegative);
  }
  bool operator==(const ClockParams&) const = default;
};

enum class WhenLost { Missing, Held };  ///< what stands in the data while a body is lost: nothing, or its last pose

/// Cameras that see markers on the bodies.
struct MotionCaptureParams {
  double rate = 360.0;            ///< Hz
  double position_noise = 0.0;    ///< m, standard deviation of one coordinate of one sample
  double rotation_noise = 0.0;    ///< rad, about each axis
  double position_error = 0.0;    ///< m, standard deviation of one coordinate of what stays the same for a body
  double rotation_error = 0.0;    ///< rad, about each axis: how its frame was set
  double lost_depth = 0.0;        ///< m: in the container, lower than this below the rim, a body may be lost
  double lost_probability = 0.0;  ///< that a body is one of those that are lost there
  double dropout_rate = 0.0;      ///< 1/s: how often a body is lost for a moment elsewhere
  double dropout_duration = 0.1;  ///< s, mean
  WhenLost when_lost = WhenLost::Missing;
  ClockParams clock;

  template <class Archive>
  void fields(Archive& a) {
    a("rate", rate, Range::Positive);
    a("position_noise", position_noise, Range::NotNegative);
    a("rotation_noise_deg", Degrees{rotation_noise}, Range::NotNegative);
    a("position_error", position_error, Range::NotNegative);
    a("rotation_error_deg", Degrees{rotation_error}, Range::NotNegative);
    a("lost_depth", lost_depth, Range::NotNegative);
    a("lost_probability", lost_probability, Range::Fraction);
    a("dropout_rate", dropout_rate, Range::NotNegative);
    a("dropout_duration", dropout_duration, Range::Positive);
    a("clock", clock);
  }
  bool operator==(const MotionCaptureParams&) const = default;
};

/// The sensor between flange and gripper.
struct ForceTorqueParams {
  double rate = 500.0;              ///< Hz
  double force_noise = 0.0;         ///< N, standard deviation of one sample
  double torque_noise = 0.0;        ///< Nm
  double force_bias = 0.0;          ///< N, standard deviation over repetitions
  double torque_bias = 0.0;         ///< Nm
  double force_drift = 0.0;         ///< N/sqrt(s): the bias walks at random
  double torque_drift = 0.0;        ///< Nm/sqrt(s)
  double acceleration_noise = 0.0;  ///< m/s^2, of the sensor's accelerometer
  ClockParams clock;

  template <class Archive>
  void fields(Archive& a) {
    a("rate", rate, Range::Positive);
    a("force_noise", force_noise, Range::NotNegative);
    a("torque_noise", torque_noise, Range::NotNegative);
    a("force_bias", force_bias, Range::NotNegative);
    a("torque_bias", torque_bias, Range::NotNegative);
    a("force_drift", force_drift, Range::NotNegative);
    a("torque_drift", torque_drift, Range::NotNegative);
    a("acceleration_noise", acceleration_noise, Range::NotNegative);
    a("clock", clock);
  }
  bool operator==(const ForceTorqueParams&) const = default;
};

/// The robot's own encoders, and the tool pose it computes from them.
struct EncoderParams {
  double rate = 125.0;               ///< Hz
  double position_noise = 0.0;       ///< rad
  double velocity_noise = 0.0;       ///< rad/s
  double tool_position_noise = 0.0;  ///< m
  double tool_rotation_noise = 0.0;  ///< rad
  ClockParams clock;

  template <class Archive>
  void fields(Archive& a) {
    a("rate", rate, Range::Positive);
    a("position_noise", position_noise, Range::NotNegative);
    a("velocity_noise", velocity_noise, Range::NotNegative);
    a("tool_position_noise", tool_position_noise, Range::NotNegative);
    a("tool_rotation_noise_deg", Degrees{tool_rotation_noise}, Range::NotNegative);
    a("clock", clock);
  }
  bool operator==(const EncoderParams&) const = default;
};

/// Without a file: three ideal sensors.
struct Sensors {
  MotionCaptureParams motion_capture;
  ForceTorqueParams force_torque;
  EncoderParams encoders;
  bool operator==(const Sensors&) const = default;
};

/// Reads a SENSORS.yaml (docs/formats.md). Throws InputError (file:line, key, got, expected, nearest name) for anything
/// it does not understand or that cannot be.
[[nodiscard]] Sensors load_sensors(const std::filesystem::path& path);
[[nodiscard]] Sensors parse_sensors(std::string_view text, std::string_view name);

}  // namespace snug::model
