// RecordingReader: opens a recording and fetches frames by number or time.
#include "snug/record/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/internal/header_file.hpp"
#include "snug/record/internal/layout.hpp"
#include "snug/record/internal/live_file.hpp"

namespace snug::record {
namespace {

using namespace internal;

constexpr std::size_t kBlockFrames = 1000;                   ///< frames read at a time
constexpr std::size_t kBlockBytes = std::size_t{24} << 20U;  ///< of fewer frames, when they are large

/// The frames [first, first + count) of all columns, as they lie in the file.
struct Block {
  std::size_t first = 0;
  std::size_t count = 0;
  std::array<std::vector<unsigned char>, kFrameColumnCount> columns;
  std::vector<std::uint8_t> present;
  std::vector<double> pose, twist;
  std::array<std::vector<double>, kJointColumnCount> joints;
};

struct Contacts {
  std::vector<std::int32_t> frame_block, block_body, block_count;
  std::vector<std::int64_t> block_first;
  std::vector<float> point, normal, force, gap;
  std::vector<std::uint8_t> state;
  std::size_t blocks = 0;  ///< rows that all block tables have
  std::size_t points = 0;  ///< rows that all point tables have
};

Handle open_file(const std::filesystem::path& path) {
  std::error_code error;
  const char* expected = "a recording written by snug simulate";
  if (!std::filesystem::exists(path, error)) throw InputError(path.string(), "", "no such file", expected);
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(path.string(), "", "not a file", expected);
  if (H5Fis_hdf5(path.c_str()) <= 0)
    throw InputError(path.string(), "", "a file that is not HDF5, or one that lost its beginning", expected);
  return open_for_reading(path);
}

void require_format(hid_t file, const std::filesystem::path& path) {
  if (!is_recording(file))
    throw InputError(path.string(), "", "an HDF5 file of another kind", "a recording written by snug simulate");
  std::int32_t version = 0;
  read_attribute(file, "format_version", H5T_NATIVE_INT32, &version);
  if (version < 1 || version > kFormatVersion)
    throw InputError(path.string(), "format_version", std::to_string(version),
                     "1 to " + std::to_string(kFormatVersion) + ": this file needs a newer snug");
}

/// The events that all columns hold: a killed run may have left some columns longer than others.
std::vector<Event> read_events(Source& source) {
  const auto times = read_all<double>(source, kEventTime);
  const auto kinds = read_texts(source, kEventKind);
  const auto bodies = read_texts(source, kEventBody);
  const auto texts = read_texts(source, kEventText);
  const auto first = read_all<std::int64_t>(source, kEventNumberFirst);
  const auto numbers = read_all<std::int32_t>(source, kEventNumberCount);
  const auto values = read_all<double>(source, kNumberValue);
  const auto names = read_texts(source, kNumberName);
  const auto known = static_cast<std::int64_t>(std::min(names.size(), values.size()));
  std::int64_t unused = known;  // no number belongs to two events
  std::vector<Event> events(
      std::min({times.size(), kinds.size(), bodies.size(), texts.size(), first.size(), numbers.size()}));
  for (std::size_t i = 0; i < events.size(); ++i) {
    events[i] = {times[i], kinds[i], bodies[i], texts[i], {}};
    unused -= std::max(0, numbers[i]);
    if (first[i] < 0 || numbers[i] < 0 || first[i] > known - numbers[i] || unused < 0)
      throw H5Error("/events refers to numbers that do not exist");
    for (auto k = static_cast<std::size_t>(first[i]); k < static_cast<std::size_t>(first[i] + numbers[i]); ++k)
      events[i].numbers.push_back({names[k], values[k]});
  }
  // Who packs says what it did when an item is done, while the plant goes on.
  std::ranges::stable_sort(events, {}, &Event::time);
  return events;
}

/// Tables of a killed run may differ in length by what was being written: the rows that all have count.
Contacts read_contacts(Source& source, bool is_complete) {
  const auto path = [](ContactColumn column) { return contact_column(column).path; };
  Contacts c;
  c.frame_block = read_all<std::int32_t>(source, path(kFrameBlock));
  c.block_body = read_all<std::int32_t>(source, path(kBlockBody), 2);
  c.block_first = read_all<std::int64_t>(source, path(kBlockFirst));
  c.block_count = read_all<std::int32_t>(source, path(kBlockCount));
  c.point = read_all<float>(source, path(kPoint), 3);
  c.normal = read_all<float>(source, path(kNormal), 3);
  c.force = read_all<float>(source, path(kForce), 3);
  c.gap = read_all<float>(source, path(kGap));
  c.state = read_all<std::uint8_t>(source, path(kState));
  const auto [points, most_points] =
      std::minmax({c.point.size() / 3, c.normal.size() / 3, c.force.size() / 3, c.gap.size(), c.state.size()});
  const auto [blocks, most_blocks] = std::minmax({c.block_body.size() / 2, c.block_first.size(), c.block_count.size()});
  if (is_complete && (points != most_points || blocks != most_blocks))
    throw H5Error("the tables of /contacts differ in length");
  c.points = points;
  c.blocks = blocks;
  return c;
}

Vector3 vector_from(const float* v) { return Eigen::Map<const Eigen::Vector3f>(v).cast<double>(); }
Vector3 vector_from(const double* v) { return {v[0], v[1], v[2]}; }
PoseSample pose_from(const double* v) { return {vector_from(v), Quaternion(v[3], v[4], v[5], v[6])}; }

/// Appends the contacts of one block.
void append_block(const Contacts& c, std::int32_t block, std::size_t body_count, std::vector<ContactSample>& out) {
  if (block < 0 || static_cast<std::size_t>(block) >= c.blocks)
    throw H5Error("/contacts/frame_block refers to a block that does not exist");
  const auto b = static_cast<std::size_t>(block);
  const std::int64_t first = c.block_first[b];
  const std::int64_t count = c.block_count[b];
  if (first < 0 || count < 0 || first > static_cast<std::int64_t>(c.points) - count)
    throw H5Error("/contacts/block_first refers to points that do not exist");
  for (std::size_t side = 0; side < 2; ++side)
    if (c.block_body[2 * b + side] < 0 || static_cast<std::size_t>(c.block_body[2 * b + side]) >= body_count)
      throw H5Error("/contacts/block_body refers to a body that does not exist");
  if (out.size() + static_cast<std::size_t>(count) > c.points)
    throw H5Error("a frame has more contacts than /contacts has points");
  for (std::int64_t i = first; i < first + count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (c.state[k] > static_cast<std::uint8_t>(ContactState::Sliding))
      throw H5Error("/contacts/state holds an unknown state");
    out.push_back({c.block_body[2 * b], c.block_body[2 * b + 1], vector_from(&c.point[3 * k]),
                   vector_from(&c.normal[3 * k]), vector_from(&c.force[3 * k]), double{c.gap[k]},
                   static_cast<ContactState>(c.state[k])});
  }
}

}  // namespace

struct RecordingReader::Impl {
  explicit Impl(const std::filesystem::path& file_path);
  void open();
  void find_times();
  void load_block(std::size_t index);
  void read_frame(std::size_t index, Frame& frame);
  void read_contacts_of(std::size_t row, Frame& frame);
  template <class T>
  const T* at(FrameColumn column, std::size_t row, std::size_t width = 1) const {
    return reinterpret_cast<const T*>(block.columns[column].data()) + row * width;
  }
  template <class Work>
  void guarded(Work work) {
    const QuietErrors quiet;
    try {
      work();
    } catch (const H5Error& error) {
      throw InputError(path.string(), "", std::string("a damaged or truncated recording (") + error.what() + ")",
                       "a recording that was not cut or changed");
    }
  }

  std::filesystem::path path;
  Handle file;
  std::optional<Source> source;
  std::size_t block_frames = kBlockFrames;
  RecordingHeader header;
  std::vector<Event> events;
  std::vector<double> times;
  bool is_complete = false;
  bool is_interrupted = false;
  std::string result;
  std::array<Handle, kFrameColumnCount> columns;
  Handle present, pose, twist;                   ///< without bodies: not open
  std::array<Handle, kJointColumnCount> joints;  ///< without a robot: not open
  Block block;
  std::optional<Contacts> contacts;
};

RecordingReader::Impl::Impl(const std::filesystem::path& file_path) : path(file_path) {
  guarded([&] { open(); });
}

void RecordingReader::Impl::open() {
  file = open_file(path);
  require_format(file.get(), path);
  source.emplace(file.get());
  header = read_header(*source);
  std::uint8_t complete = 0;
  read_attribute(file.get(), "complete", H5T_NATIVE_UINT8, &complete);
  is_complete = complete == 1;
  std::uint8_t interrupted = 0;
  if (has_attribute(file.get(), "interrupted"))
    read_attribute(file.get(), "interrupted", H5T_NATIVE_UINT8, &interrupted);
  is_interrupted = interrupted == 1;
  for (std::size_t i = 0; i < kFrameColumnCount; ++i)
    columns[i] = open_dataset(file.get(), frame_column(static_cast<FrameColumn>(i)).path);
  const std::size_t bodies = header.bodies.size();
  if (bodies > 0) {
    present = open_dataset(file.get(), body_present_column(bodies).path);
    pose = open_dataset(file.get(), body_pose_column(bodies).path);
    twist = open_dataset(file.get(), body_twist_column(bodies).path);
  }
  if (const std::size_t count = header.joints.size(); count > 0) {
    for (std::size_t i = 0; i < kJointColumnCount; ++i)
      joints[i] = open_dataset(file.get(), joint_column(i, count).path);
  }
  find_times();
  events = read_events(*source);
  if (has_link(file.get(), kResult)) result = read_text(*source, kResult);
  std::size_t frame_bytes = header.bodies.size() * (7 + 6) * sizeof(double) + header.joints.size() * 3 * sizeof(double);
  frame_bytes += 1024;  // the columns of fixed width
  block_frames = std::clamp<std::size_t>(kBlockBytes / frame_bytes, 1, kBlockFrames);
}

/// Counts the frames that all columns have. Times that do not grow end the recording of a killed run, and mean that
/// the file is damaged otherwise.
void RecordingReader::Impl::find_times() {
  std::size_t count = std::numeric_limits<std::size_t>::max();
  std::size_t longest = 0;
  const auto look = [&](const Handle& column, const Dims& row) {
    const Dims dims = dims_of(column.get());
    if (dims.empty() || !std::equal(dims.begin() + 1, dims.end(), row.begin(), row.end()))
      throw H5Error("a column has an unexpected shape");
    count = std::min(count, static_cast<std::size_t>(dims[0]));
    longest = std::max(longest, static_cast<std::size_t>(dims[0]));
  };
  for (std::size_t i = 0; i < kFrameColumnCount; ++i) {
    const std::size_t width = frame_column(static_cast<FrameColumn>(i)).width;
    look(columns[i], width > 1 ? Dims{width} : Dims{});
  }
  const hsize_t bodies = header.bodies.size();
  if (bodies > 0) {
    look(present, {bodies});
    look(pose, {bodies, 7});
    look(twist, {bodies, 6});
  }
  if (!header.joints.empty()) {
    for (const Handle& column : joints) look(column, {header.joints.size()});
  }
  if (is_complete && longest != count) throw H5Error("the columns differ in length");
  source->take_numbers(frame_column(kTime).path, count, sizeof(double));
  times.resize(count);
  if (count > 0) read_rows(columns[kTime].get(), H5T_NATIVE_DOUBLE, 0, count, times.data());
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isfinite(times[i]) && (i == 0 || times[i] > times[i - 1])) continue;
    if (is_complete) throw H5Error("time does not grow at frame " + std::to_string(i));
    times.resize(i);
    break;
  }
}

void RecordingReader::Impl::load_block(std::size_t index) {
  if (index >= block.first && index < block.first + block.count) return;
  if (!contacts) contacts = read_contacts(*source, is_complete);
  block.count = 0;  // stays so if reading throws
  const std::size_t first = index - index % block_frames;
  const std::size_t count = std::min(block_frames, times.size() - first);
  for (std::size_t i = 0; i < kFrameColumnCount; ++i) {
    const ColumnSpec& spec = frame_column(static_cast<FrameColumn>(i));
    block.columns[i].resize(count * spec.width * spec.value_bytes);
    read_rows(columns[i].get(), spec.type, first, count, block.columns[i].data());
  }
  const std::size_t bodies = header.bodies.size();
  if (bodies > 0) {
    block.present.resize(count * bodies);
    block.pose.resize(count * bodies * 7);
    block.twist.resize(count * bodies * 6);
    read_rows(present.get(), H5T_NATIVE_UINT8, first, count, block.present.data());
    read_rows(pose.get(), H5T_NATIVE_DOUBLE, first, count, block.pose.data());
    read_rows(twist.get(), H5T_NATIVE_DOUBLE, first, count, block.twist.data());
  }
  if (const std::size_t width = header.joints.size(); width > 0) {
    for (std::size_t i = 0; i < kJointColumnCount; ++i) {
      block.joints[i].resize(count * width);
      read_rows(joints[i].get(), H5T_NATIVE_DOUBLE, first, count, block.joints[i].data());
    }
  }
  block.first = first;
  block.count = count;
}

void RecordingReader::Impl::read_frame(std::size_t index, Frame& frame) {
  load_block(index);
  const std::size_t row = index - block.first;
  const auto twist_from_row = [&](FrameColumn column) {
    const double* v = at<double>(column, row, 6);
    return Twist{vector_from(v), vector_from(v + 3)};
  };
  const auto wrench_from_row = [&](FrameColumn column) {
    const double* v = at<double>(column, row, 6);
    return Wrench{vector_from(v), vector_from(v + 3)};
  };
  frame.time = *at<double>(kTime, row);
  frame.step = *at<std::int64_t>(kStep, row);
  frame.program_row = *at<std::int32_t>(kProgramRow, row);
  frame.X_WE = pose_from(at<double>(kToolPose, row, 7));
  frame.V_WE = twist_from_row(kToolTwist);
  frame.X_WE_command = pose_from(at<double>(kToolPoseCommand, row, 7));
  CupSample& cup = frame.cup;
  cup.vacuum_command = *at<std::uint8_t>(kVacuumCommand, row) != 0;
  cup.blow_off_command = *at<std::uint8_t>(kBlowOffCommand, row) != 0;
  cup.pressure_gauge = *at<double>(kPressureGauge, row);
  cup.attached_body = *at<std::int32_t>(kAttachedBody, row);
  cup.X_ES = pose_from(at<double>(kCupPose, row, 7));
  cup.length = *at<double>(kCupLength, row);
  cup.bend = *at<double>(kCupBend, row);
  cup.F_PSo_S = wrench_from_row(kCupWrench);
  frame.F_flange = wrench_from_row(kFlangeWrench);
  frame.solver.residual = *at<double>(kSolverResidual, row);
  frame.solver.iterations = *at<std::int32_t>(kSolverIterations, row);
  const std::uint8_t status = *at<std::uint8_t>(kSolverStatus, row);
  const std::size_t bodies = header.bodies.size();
  if (cup.attached_body < -1 || cup.attached_body >= static_cast<int>(bodies))
    throw H5Error("/cup/attached_body refers to a body that does not exist");
  if (status > static_cast<std::uint8_t>(SolverStatus::Failed)) throw H5Error("/solver/status holds an unknown status");
  frame.solver.status = static_cast<SolverStatus>(status);
  frame.bodies.resize(bodies);
  for (std::size_t i = 0; i < bodies; ++i) {
    const std::size_t k = row * bodies + i;
    BodySample& body = frame.bodies[i];
    body.present = block.present[k] != 0;
    body.X_WB = pose_from(&block.pose[7 * k]);
    body.V_WB = {vector_from(&block.twist[6 * k]), vector_from(&block.twist[6 * k + 3])};
  }
  const std::size_t joint_count = header.joints.size();
  frame.joints.resize(joint_count);
  for (std::size_t i = 0; i < joint_count; ++i) {
    const std::size_t k = row * joint_count + i;
    frame.joints[i] = {block.joints[0][k], block.joints[1][k], block.joints[2][k]};
  }
  read_contacts_of(row, frame);
}

void RecordingReader::Impl::read_contacts_of(std::size_t row, Frame& frame) {
  const std::int64_t first = *at<std::int64_t>(kContactFirst, row);
  const std::int64_t count = *at<std::int32_t>(kContactCount, row);
  if (first < 0 || count < 0 || first > static_cast<std::int64_t>(contacts->frame_block.size()) - count)
    throw H5Error("/contacts/frame_first refers to blocks that do not exist");
  frame.contacts.clear();
  for (std::int64_t i = first; i < first + count; ++i)
    append_block(*contacts, contacts->frame_block[static_cast<std::size_t>(i)], header.bodies.size(), frame.contacts);
}

RecordingReader::RecordingReader(const std::filesystem::path& path) : impl_(std::make_unique<Impl>(path)) {}
RecordingReader::~RecordingReader() = default;
RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;
RecordingReader& RecordingReader::operator=(RecordingReader&&) noexcept = default;

const RecordingHeader& RecordingReader::header() const { return impl_->header; }
const std::vector<Event>& RecordingReader::events() const { return impl_->events; }
const std::vector<double>& RecordingReader::times() const { return impl_->times; }
bool RecordingReader::is_complete() const { return impl_->is_complete; }
bool RecordingReader::is_interrupted() const { return impl_->is_interrupted; }
std::size_t RecordingReader::file_bytes() const { return impl_->source->size(); }
const std::string& RecordingReader::result() const { return impl_->result; }

std::size_t RecordingReader::find_frame(double time) const {
  const std::vector<double>& times = impl_->times;
  SNUG_CHECK(!times.empty(), "find_frame needs a recording with frames");
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  return after == times.begin() ? 0 : static_cast<std::size_t>(after - times.begin()) - 1;
}

void RecordingReader::read_frame(std::size_t index, Frame& frame) {
  SNUG_CHECK(index < impl_->times.size(), "frame index within the recording");
  impl_->guarded([&] { impl_->read_frame(index, frame); });
}

Recording load_recording(const std::filesystem::path& path) {
  RecordingReader reader(path);
  Recording recording{reader.header(), {}, reader.events(), reader.is_complete(), reader.result()};
  recording.frames.resize(reader.frame_count());
  for (std::size_t i = 0; i < recording.frames.size(); ++i) reader.read_frame(i, recording.frames[i]);
  return recording;
}

}  // namespace snug::record
