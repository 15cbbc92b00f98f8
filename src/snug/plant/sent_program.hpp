// SentProgram: any plant, and beside it the program that it is sent, in a file that is whole at any time.
#pragma once

#include "snug/core/output_file.hpp"
#include "snug/plant/event.hpp"

namespace snug::plant {

/// The first line of a program that may not be all that is sent.
inline constexpr const char* kUnfinishedProgram = "# incomplete, the session had not ended\n";

/// Hands everything on. The first waypoint of each motion departs no earlier than it was sent. After each start the
/// file holds every waypoint that was sent until then; it appears at its path with the first, where no earlier file is
/// there: that one stays until finish(), and the new one is beside it.
class SentProgram final : public Plant {
 public:
  /// `file` and `plant` are not owned. `tracking`: with which the plant moves; `robot`: the name of the one that moves
  /// the tool, or empty.
  SentProgram(Plant& plant, OutputFile& file, const motion::Tracking& tracking, std::string robot = {});

  [[nodiscard]] Description describe() const override { return plant_.describe(); }
  [[nodiscard]] Feedback read() override { return plant_.read(); }
  [[nodiscard]] bool is_moving() const override { return plant_.is_moving(); }
  /// Throws OutputError where the file cannot be written.
  void start(const Motion& motion) override;
  [[nodiscard]] std::vector<Event> advance() override { return plant_.advance(); }
  void cancel() override { plant_.cancel(); }
  [[nodiscard]] bool bring(const model::ParcelId& item) override { return plant_.bring(item); }
  void perceive(std::span<const perception::Expectation> expected) override { plant_.perceive(expected); }
  void acknowledge() override { plant_.acknowledge(); }

  /// The session has ended: the file is complete. Nothing where nothing was sent.
  void finish();

 private:
  Plant& plant_;
  OutputFile& file_;
  motion::Program program_;
  double begin_ = 0.0;  ///< s, of the plant's time, when the first motion was sent
};

}  // namespace snug::plant
