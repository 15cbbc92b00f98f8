// RecordingWriter: appends frames and events to a file that stays readable if the run is killed.
#include "snug/record/writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/units.hpp"
#include "snug/record/internal/commit_driver.hpp"
#include "snug/record/internal/contact_log.hpp"
#include "snug/record/internal/dimension_scales.hpp"
#include "snug/record/internal/header_file.hpp"
#include "snug/record/internal/layout.hpp"

namespace snug::record {
namespace {

using namespace internal;

void validate(const std::filesystem::path& path, const RecordingHeader& header) {
  const auto refuse = [&](const char* key, const std::string& got, const char* expected) {
    throw InputError(path.string(), key, got, expected);
  };
  if (!(header.record_period > 0.0) || !std::isfinite(header.record_period))
    refuse("record_period", std::to_string(header.record_period), "a time between frames, s, > 0");
  std::set<std::string> names;
  for (const BodyInfo& body : header.bodies) {
    if (body.name.empty()) refuse("bodies", "a body without a name", "a name for each body");
    if (!names.insert(body.name).second) refuse("bodies", '"' + body.name + "\" twice", "unique names");
  }
}

/// Replaces nothing but an earlier recording or an empty file.
void refuse_foreign_file(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return;
  const char* expected = "a path that is free or holds an earlier recording";
  if (!std::filesystem::is_regular_file(path, error))
    throw InputError(path.string(), "", "something that is not a regular file", expected);
  if (std::filesystem::file_size(path, error) == 0) return;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  bool is_ours = false;
  if (file >= 0) {
    is_ours = is_recording(file);
    H5Fclose(file);
  }
  if (!is_ours) throw InputError(path.string(), "", "a file that is not a recording: not overwritten", expected);
}

/// An open file and the driver that writes it.
struct OpenFile {
  Handle driver;
  Handle file;
};

OpenFile create_file(const std::filesystem::path& path) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), "file access");
  // The formats up to HDF5 1.8 have no "open for writing" mark: the file of a killed run opens with any reader. The
  // oldest that does is taken: in newer ones more than eight attributes go to a heap that small readers, as the page's,
  // do not know.
  check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V18), "file access");
  OpenFile output;
  output.driver = use_commit_driver(access.get());
  output.file = Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), "create file");
  return output;
}

struct Row7 {
  double v[7];
};
struct Row6 {
  double v[6];
};

Row7 row_of(const PoseSample& X) {
  return {{X.p.x(), X.p.y(), X.p.z(), X.quat.w(), X.quat.x(), X.quat.y(), X.quat.z()}};
}
Row6 row_of(const Vector3& a, const Vector3& b) { return {{a.x(), a.y(), a.z(), b.x(), b.y(), b.z()}}; }

constexpr Row7 kAbsentPose = {{kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}};
constexpr Row6 kAbsentTwist = {{kNaN, kNaN, kNaN, kNaN, kNaN, kNaN}};

/// Appends `text` padded with zeros to the width of the column, cut at the end of a UTF-8 character if it is longer.
template <std::size_t kBytes>
void put_text(FlatColumn& column, const std::string& text) {
  std::array<char, kBytes> padded = {};
  std::size_t size = std::min(text.size(), kBytes);
  const auto is_inside_character = [&](std::size_t at) {
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
  };
  while (size > 0 && is_inside_character(size)) --size;
  text.copy(padded.data(), size);
  column.put(padded.data(), 1);
}

class EventLog {
 public:
  explicit EventLog(hid_t file) {
    const auto text = [&](const char* path, std::size_t bytes) {
      text_types_.push_back(string_type(bytes));
      return ColumnSpec{.path = path, .type = text_types_.back().get(), .value_bytes = bytes};
    };
    const ColumnSpec specs[] = {
        text(kNumberName, kEventWordBytes),
        column_of<double>(kNumberValue, 1, "as its name says", "", ""),
        column_of<double>(kEventTime, 1, "s", "", ""),
        text(kEventKind, kEventWordBytes),
        text(kEventBody, kEventWordBytes),
        text(kEventText, kEventTextBytes),
        column_of<std::int64_t>(kEventNumberFirst, 1, "row of /events/number_name", "", ""),
        column_of<std::int32_t>(kEventNumberCount, 1, "rows of /events/number_name", "", ""),
    };
    for (const ColumnSpec& spec : specs) columns_.emplace_back(file, spec);
  }

  void append(const Event& event) {
    const auto count = static_cast<std::int32_t>(event.numbers.size());
    for (const EventNumber& number : event.numbers) {
      put_text<kEventWordBytes>(columns_[0], number.name);
      columns_[1].put(&number.value, 1);
    }
    columns_[2].put(&event.time, 1);
    put_text<kEventWordBytes>(columns_[3], event.kind);
    put_text<kEventWordBytes>(columns_[4], event.body);
    put_text<kEventTextBytes>(columns_[5], event.text);
    columns_[6].put(&number_rows_, 1);
    columns_[7].put(&count, 1);
    number_rows_ += count;
  }

  void write() {
    for (FlatColumn& column : columns_) column.write();
  }

 private:
  std::vector<Handle> text_types_;
  std::vector<FlatColumn> columns_;
  std::int64_t number_rows_ = 0;
};

}  // namespace

struct RecordingWriter::Impl {
  Impl(OutputFile output_file, const RecordingHeader& header, ProgramText program);
  void append(const Frame& frame);
  void put_frame(const Frame& frame);
  void put_bodies(const Frame& frame);
  void put_joints(const Frame& frame);
  void write();
  void close(std::optional<RunEnd> end, const std::string& result_json);
  void give_up() noexcept;
  /// Runs `work` with HDF5 quiet; its errors become OutputErrors that name the file.
  template <class Work>
  void guarded(Work work) {
    const QuietErrors quiet;
    try {
      work();
    } catch (const H5Error& error) {
      has_failed = true;
      throw OutputError(file.path().string(), error.what());
    } catch (const OutputError&) {
      has_failed = true;
      throw;
    }
  }

  OutputFile file;
  bool has_failed = false;  ///< to write
  std::size_t body_count;
  std::size_t joint_count;
  std::size_t chunk_rows;
  OpenFile output;
  std::vector<Column> columns;        ///< by FrameColumn
  std::vector<Column> body_columns;   ///< present, pose, twist; none without bodies
  std::vector<Column> joint_columns;  ///< position, velocity, torque; none without a robot
  std::vector<double> joint_row;
  std::optional<ContactLog> contacts;
  std::optional<EventLog> events;
  std::optional<FlatColumn> program;  ///< of one that grows
  std::string program_text;           ///< of it, whole
  std::vector<std::uint8_t> present;
  hsize_t chunk_first = 0;  ///< row of the file at which the chunk being filled starts
  std::size_t filled = 0;   ///< rows in it
  double last_time = -std::numeric_limits<double>::infinity();
};

RecordingWriter::Impl::Impl(OutputFile output_file, const RecordingHeader& header, ProgramText program_kind)
    : file(std::move(output_file)), body_count(header.bodies.size()), joint_count(header.joints.size()), chunk_rows(0) {
  validate(file.path(), header);
  chunk_rows = chunk_rows_for(header.record_period);
  guarded([&] {
    output = create_file(file.location());
    write_header(output.file.get(), header);
    if (program_kind == ProgramText::Known) {
      write_text(output.file.get(), kProgram, header.program_text);
    } else {
      program.emplace(output.file.get(), column_of<std::uint8_t>(kProgramSoFar, 1, "UTF-8", "", ""));
    }
    // The commit driver writes the lengths of datasets in the order of their creation: what is referred to first.
    events.emplace(output.file.get());
    contacts.emplace(output.file.get());
    if (body_count > 0) {
      body_columns.emplace_back(output.file.get(), body_present_column(body_count), chunk_rows);
      body_columns.emplace_back(output.file.get(), body_pose_column(body_count), chunk_rows);
      body_columns.emplace_back(output.file.get(), body_twist_column(body_count), chunk_rows);
    }
    if (joint_count > 0) {
      for (std::size_t i = 0; i < kJointColumnCount; ++i)
        joint_columns.emplace_back(output.file.get(), joint_column(i, joint_count), chunk_rows);
    }
    for (std::size_t i = 0; i < kFrameColumnCount; ++i)
      columns.emplace_back(output.file.get(), frame_column(static_cast<FrameColumn>(i)), chunk_rows);
    present.resize(body_count);
    write_dimension_scales(output.file.get(), body_count > 0, joint_count > 0);
    check(H5Fflush(output.file.get(), H5F_SCOPE_LOCAL), "flush");
  });
}

void RecordingWriter::Impl::append(const Frame& frame) {
  SNUG_CHECK(std::isfinite(frame.time) && frame.time > last_time, "time of a frame must be finite and grow");
  SNUG_CHECK(frame.bodies.size() == body_count, "a frame must have the bodies of the header");
  SNUG_CHECK(frame.joints.size() == joint_count, "a frame must have the joints of the header");
  const int bodies = static_cast<int>(body_count);
  SNUG_CHECK(frame.cup.attached_body >= -1 && frame.cup.attached_body < bodies, "attached body must exist");
  for (const ContactSample& contact : frame.contacts)
    SNUG_CHECK(contact.body_a >= 0 && contact.body_a < bodies && contact.body_b >= 0 && contact.body_b < bodies,
               "bodies of a contact must exist");
  last_time = frame.time;
  put_frame(frame);
  put_bodies(frame);
  put_joints(frame);
  if (++filled == chunk_rows) guarded([&] { write(); });
}

void RecordingWriter::Impl::put_frame(const Frame& frame) {
  const std::size_t row = filled;
  const auto put = [&](FrameColumn column, const auto& value) { columns[column].put(row, &value); };
  const CupSample& cup = frame.cup;
  const ContactLog::Range range = contacts->append(frame.contacts);
  put(kTime, frame.time);
  put(kStep, frame.step);
  put(kProgramRow, std::int32_t{frame.program_row});
  put(kToolPose, row_of(frame.X_WE));
  put(kToolTwist, row_of(frame.V_WE.linear, frame.V_WE.angular));
  put(kToolPoseCommand, row_of(frame.X_WE_command));
  put(kVacuumCommand, static_cast<std::uint8_t>(cup.vacuum_command));
  put(kBlowOffCommand, static_cast<std::uint8_t>(cup.blow_off_command));
  put(kPressureGauge, cup.pressure_gauge);
  put(kAttachedBody, std::int32_t{cup.attached_body});
  put(kCupPose, row_of(cup.X_ES));
  put(kCupLength, cup.length);
  put(kCupBend, cup.bend);
  put(kCupWrench, row_of(cup.F_PSo_S.force, cup.F_PSo_S.torque));
  put(kFlangeWrench, row_of(frame.F_flange.force, frame.F_flange.torque));
  put(kSolverResidual, frame.solver.residual);
  put(kSolverIterations, std::int32_t{frame.solver.iterations});
  put(kSolverStatus, static_cast<std::uint8_t>(frame.solver.status));
  put(kContactFirst, range.first);
  put(kContactCount, range.count);
}

void RecordingWriter::Impl::put_bodies(const Frame& frame) {
  if (body_count == 0) return;
  for (std::size_t i = 0; i < body_count; ++i) {
    const BodySample& body = frame.bodies[i];
    const Row7 pose = body.present ? row_of(body.X_WB) : kAbsentPose;
    const Row6 twist = body.present ? row_of(body.V_WB.linear, body.V_WB.angular) : kAbsentTwist;
    present[i] = static_cast<std::uint8_t>(body.present);
    body_columns[1].put(filled, pose.v, i);
    body_columns[2].put(filled, twist.v, i);
  }
  body_columns[0].put(filled, present.data());
}

void RecordingWriter::Impl::put_joints(const Frame& frame) {
  constexpr double JointSample::*kParts[kJointColumnCount] = {&JointSample::position, &JointSample::velocity,
                                                              &JointSample::torque};
  for (std::size_t i = 0; i < joint_columns.size(); ++i) {
    joint_row.clear();
    for (const JointSample& joint : frame.joints) joint_row.push_back(joint.*kParts[i]);
    joint_columns[i].put(filled, joint_row.data());
  }
}

/// Writes the chunk as far as it is filled, with all it refers to, and commits. The first commit makes the recording
/// visible, but an earlier one stays in its place until the new one has its end.
void RecordingWriter::Impl::write() {
  events->write();
  if (program) program->write();
  contacts->write();
  if (filled > 0) {
    for (Column& column : body_columns) column.write(chunk_first, filled);
    for (Column& column : joint_columns) column.write(chunk_first, filled);
    for (Column& column : columns) column.write(chunk_first, filled);
  }
  if (filled == chunk_rows) {
    chunk_first += chunk_rows;
    filled = 0;
  }
  check(H5Fflush(output.file.get(), H5F_SCOPE_LOCAL), "flush");
  if (!file.is_published() && !file.replaces_file()) file.publish();
}

/// Without `end` the run did not get there.
void RecordingWriter::Impl::close(std::optional<RunEnd> end, const std::string& result_json) {
  guarded([&] {
    if (program && end) write_text(output.file.get(), kProgram, program_text);
    if (!result_json.empty()) write_text(output.file.get(), kResult, result_json);
    write();  // commits; only then may the file be called complete
    const std::uint8_t complete = end == RunEnd::Complete ? 1 : 0;
    const std::uint8_t interrupted = end == RunEnd::Interrupted ? 1 : 0;
    update_attribute(output.file.get(), "interrupted", H5T_NATIVE_UINT8, &interrupted);
    update_attribute(output.file.get(), "complete", H5T_NATIVE_UINT8, &complete);
    check(H5Fflush(output.file.get(), H5F_SCOPE_LOCAL), "flush");
    contacts.reset();
    events.reset();
    program.reset();
    columns.clear();
    body_columns.clear();
    joint_columns.clear();
    output.file.reset();
    if (end && !file.is_published()) file.publish();
  });
}

/// Keeps the frames there are of a run that did not get to its end, unless an earlier recording or a failed write is in
/// the way.
void RecordingWriter::Impl::give_up() noexcept {
  const QuietErrors quiet;
  const bool has_frames = last_time > -std::numeric_limits<double>::infinity();
  if (has_failed || !has_frames || (file.replaces_file() && !file.is_published())) return;
  try {
    close(std::nullopt, {});
  } catch (const OutputError&) {  // nobody to tell; the file keeps what was written before
  }
}

OutputFile reserve_recording(const std::filesystem::path& path) {
  OutputFile file(path);
  const QuietErrors quiet;
  refuse_foreign_file(path);
  return file;
}

RecordingWriter::RecordingWriter(const std::filesystem::path& path, const RecordingHeader& header)
    : RecordingWriter(reserve_recording(path), header) {}

RecordingWriter::RecordingWriter(OutputFile file, const RecordingHeader& header, ProgramText program)
    : impl_(std::make_unique<Impl>(std::move(file), header, program)) {}

RecordingWriter::RecordingWriter(RecordingWriter&&) noexcept = default;

RecordingWriter& RecordingWriter::operator=(RecordingWriter&& other) noexcept {
  std::swap(impl_, other.impl_);
  return *this;
}

RecordingWriter::~RecordingWriter() {
  if (!impl_) return;
  impl_->give_up();
  const QuietErrors quiet;
  impl_.reset();
}

void RecordingWriter::append(const Frame& frame) {
  SNUG_CHECK(impl_ != nullptr, "recording is closed");
  impl_->append(frame);
}

void RecordingWriter::append(const Event& event) {
  SNUG_CHECK(impl_ != nullptr, "recording is closed");
  impl_->events->append(event);
}

void RecordingWriter::append_program(std::string_view lines) {
  SNUG_CHECK(impl_ != nullptr && impl_->program, "the program of this recording does not grow, or it is closed");
  impl_->program->put(lines.data(), lines.size());
  impl_->program_text += lines;
}

void RecordingWriter::flush() {
  SNUG_CHECK(impl_ != nullptr, "recording is closed");
  impl_->guarded([&] { impl_->write(); });
}

void RecordingWriter::close(const std::string& result_json, RunEnd end) {
  SNUG_CHECK(impl_ != nullptr, "recording is closed");
  const QuietErrors quiet;
  const std::unique_ptr<Impl> impl = std::move(impl_);
  impl->close(end, result_json);
}

void save_recording(const std::filesystem::path& path, const Recording& recording) {
  RecordingWriter writer(path, recording.header);
  for (const Event& event : recording.events) writer.append(event);
  for (const Frame& frame : recording.frames) writer.append(frame);
  writer.close(recording.result);
}

}  // namespace snug::record
