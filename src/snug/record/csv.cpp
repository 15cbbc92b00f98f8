// CSV: a recording as one table with the column names of mc_rtc logs, for spreadsheets and plotting programs.
#include "snug/record/csv.hpp"

#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "snug/core/check.hpp"
#include "snug/core/csv_cell.hpp"

namespace snug::record {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

/// Cells and rows, gathered before they are written.
class Table {
 public:
  explicit Table(OutputFile file) : file_(std::move(file)) { buffer_.reserve(kBufferBytes); }

  void cell(std::string_view text) {
    if (!is_first_) buffer_ += ';';
    is_first_ = false;
    buffer_ += text;
  }
  /// Shortest form that reads back to the same number; empty when it is not one.
  void cell(double value) {
    if (!std::isfinite(value)) return cell(std::string_view());
    char text[32];
    const std::to_chars_result end = std::to_chars(text, text + sizeof text, value);
    cell(std::string_view(text, static_cast<std::size_t>(end.ptr - text)));
  }
  void cell(int value) { cell(std::string_view(std::to_string(value))); }
  void cell(const Vector3& v) {
    for (const double x : {v.x(), v.y(), v.z()}) cell(x);
  }
  void cell(const Quaternion& q) {
    for (const double x : {q.w(), q.x(), q.y(), q.z()}) cell(x);
  }
  void empty_cells(int count) {
    for (int i = 0; i < count; ++i) cell(std::string_view());
  }
  void end_row() {
    buffer_ += '\n';
    is_first_ = true;
    if (buffer_.size() > kBufferBytes - 65536) spill();
  }
  void publish() {
    spill();
    file_.publish();
  }

 private:
  void spill() {
    file_.write(buffer_);
    buffer_.clear();
  }

  OutputFile file_;
  std::string buffer_;
  bool is_first_ = true;
};

/// Inverse rotation with the sign nearest to the previous one of the same column, so that curves do not jump.
class LoggedRotation {
 public:
  Quaternion next(const Quaternion& quat_WB) {
    Quaternion inverse = quat_WB.conjugate();
    if (inverse.dot(previous_) < 0.0) inverse.coeffs() = -inverse.coeffs();
    if (inverse.coeffs().allFinite()) previous_ = inverse;
    return inverse;
  }

 private:
  Quaternion previous_ = Quaternion(1.0, 0.0, 0.0, 0.0);
};

void name_columns(Table& table, const std::string& prefix, std::string_view suffixes) {
  for (const char suffix : suffixes) table.cell(prefix + '_' + suffix);
}

void name_pose(Table& table, const std::string& prefix) {
  name_columns(table, prefix + "_orientation", "wxyz");
  name_columns(table, prefix + "_position", "xyz");
}

void name_wrench(Table& table, const std::string& prefix) {
  for (const char* part : {"cx", "cy", "cz", "fx", "fy", "fz"}) table.cell(prefix + '_' + part);
}

void write_names(Table& table, const RecordingHeader& header) {
  table.cell("t");
  name_pose(table, "tool");
  for (const char* part : {"wx", "wy", "wz", "vx", "vy", "vz"}) table.cell(std::string("tool_velocity_") + part);
  name_pose(table, "tool_command");
  name_wrench(table, "UR10FTSensor");
  for (const char* name : {"vacuum", "blow_off", "pressure_gauge", "cup_attached", "cup_length", "cup_bend"})
    table.cell(name);
  name_pose(table, "cup");
  name_wrench(table, "cup_wrench");
  for (const char* name : {"program_row", "contacts", "solver_residual", "solver_iterations", "solver_status"})
    table.cell(name);
  for (const BodyInfo& body : header.bodies)
    if (body.kind != BodyKind::Static) name_pose(table, log_name(body.name) + "_FloatingBase");
  if (!header.container.name.empty()) name_pose(table, log_name(header.container.name) + "_FloatingBase");
  for (const char* part : {"qIn", "alphaIn", "tauIn"})
    for (std::size_t i = 0; i < header.joints.size(); ++i) table.cell(std::string(part) + '_' + std::to_string(i));
  table.end_row();
}

/// Writes frames in order; keeps the last quaternions.
class FrameRows {
 public:
  explicit FrameRows(const RecordingHeader& header) : header_(header), bodies_(header.bodies.size()) {}

  void write(Table& table, const Frame& frame) {
    SNUG_CHECK(frame.bodies.size() == bodies_.size(), "a frame must have the bodies of the header");
    table.cell(frame.time);
    write_pose(table, tool_, frame.X_WE);
    table.cell(frame.V_WE.angular);
    table.cell(frame.V_WE.linear);
    write_pose(table, command_, frame.X_WE_command);
    write_wrench(table, frame.F_flange);
    write_cup(table, frame.cup);
    table.cell(frame.program_row);
    table.cell(static_cast<int>(frame.contacts.size()));
    table.cell(frame.solver.residual);
    table.cell(frame.solver.iterations);
    table.cell(static_cast<int>(frame.solver.status));
    write_bodies(table, frame);
    for (const auto part : {&JointSample::position, &JointSample::velocity, &JointSample::torque})
      for (const JointSample& joint : frame.joints) table.cell(joint.*part);
    table.end_row();
  }

 private:
  static void write_pose(Table& table, LoggedRotation& rotation, const PoseSample& X) {
    table.cell(rotation.next(X.quat));
    table.cell(X.p);
  }
  static void write_wrench(Table& table, const Wrench& F) {
    table.cell(F.torque);
    table.cell(F.force);
  }
  void write_cup(Table& table, const CupSample& cup) {
    table.cell(cup.vacuum_command ? 1 : 0);
    table.cell(cup.blow_off_command ? 1 : 0);
    table.cell(cup.pressure_gauge);
    if (cup.attached_body < 0)
      table.empty_cells(1);
    else
      table.cell(log_name(header_.bodies[static_cast<std::size_t>(cup.attached_body)].name));
    table.cell(cup.length);
    table.cell(cup.bend);
    write_pose(table, cup_, cup.X_ES);
    write_wrench(table, cup.F_PSo_S);
  }
  void write_bodies(Table& table, const Frame& frame) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (header_.bodies[i].kind == BodyKind::Static) continue;
      if (frame.bodies[i].present)
        write_pose(table, bodies_[i], frame.bodies[i].X_WB);
      else
        table.empty_cells(7);
    }
    if (!header_.container.name.empty()) write_pose(table, container_, header_.container.X_WT);
  }

  const RecordingHeader& header_;
  LoggedRotation tool_, command_, cup_, container_;
  std::vector<LoggedRotation> bodies_;
};

}  // namespace

std::string log_name(const std::string& name) {
  std::string prefix = csv_cell(name);
  const bool is_numbered_box = name.size() > 3 && std::isdigit(static_cast<unsigned char>(name[3])) != 0 &&
                               (name.starts_with("BOX") || name.starts_with("Box"));
  if (is_numbered_box) prefix.replace(0, 3, "box");
  for (char& c : prefix)
    if (c == ' ') c = '_';
  return prefix;
}

struct CsvWriter::Impl {
  Impl(OutputFile file, const RecordingHeader& recording_header)
      : table(std::move(file)), header(recording_header), rows(header) {
    write_names(table, header);
  }

  Table table;
  RecordingHeader header;
  FrameRows rows;
  double last_time = -std::numeric_limits<double>::infinity();
};

CsvWriter::CsvWriter(OutputFile file, const RecordingHeader& header)
    : impl_(std::make_unique<Impl>(std::move(file), header)) {}
CsvWriter::~CsvWriter() = default;

void CsvWriter::append(const Frame& frame) {
  SNUG_CHECK(std::isfinite(frame.time) && frame.time > impl_->last_time, "time of a frame must be finite and grow");
  impl_->last_time = frame.time;
  impl_->rows.write(impl_->table, frame);
}

void CsvWriter::close() { impl_->table.publish(); }

void write_csv(const Recording& recording, OutputFile file) {
  CsvWriter writer(std::move(file), recording.header);
  for (const Frame& frame : recording.frames) writer.append(frame);
  writer.close();
}

}  // namespace snug::record
