// CupPoses: from CSV; the law from and to YAML.
#include "snug/identification/cup_poses.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/table.hpp"
#include "snug/identification/internal/measured_table.hpp"

namespace snug::identification {
namespace {

constexpr double kMilli = 1e-3;

std::string numbers_text(const double* values, Eigen::Index count) {
  std::string text = "[";
  for (Eigen::Index i = 0; i < count; ++i) text += fmt::format("{}{:.7g}", i > 0 ? ", " : "", values[i]);
  return text + "]";
}

/// Each field as a line.
struct KeyWriter {
  std::string& text;
  void operator()(const char* key, double value, Range) const { text += fmt::format("    {}: {:.7g}\n", key, value); }
};

std::vector<double> law_numbers(const YAML::Node& parent, const std::string& key, std::size_t count,
                                const std::string& name) {
  const YAML::Node node = parent[key];
  const std::string expected = fmt::format("{} finite number{}", count, count == 1 ? "" : "s");
  const auto where = [&name](const YAML::Node& at) { return fmt::format("{}:{}", name, at.Mark().line + 1); };
  if (!node) throw InputError(where(parent), "law." + key, "nothing", expected);
  std::vector<double> values;
  try {
    values = node.IsSequence() ? node.as<std::vector<double>>() : std::vector<double>{node.as<double>()};
  } catch (const YAML::Exception&) {
    throw InputError(where(node), "law." + key, "something else", expected);
  }
  bool is_fine = values.size() == count;
  for (const double value : values) is_fine = is_fine && std::isfinite(value);
  if (!is_fine) throw InputError(where(node), "law." + key, fmt::format("{} values", values.size()), expected);
  return values;
}

}  // namespace

CupPoses parse_cup_poses(const std::string& text, const std::string& name) {
  const Table table = parse_table(
      text, name,
      {"x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz", "fx_N", "fy_N", "fz_N", "tx_Nmm", "ty_Nmm", "tz_Nmm"});
  CupPoses poses;
  poses.source = name;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    for (std::size_t column = 0; column < table.columns.size(); ++column)
      if (!std::isfinite(table.rows[i][column]))
        throw InputError(table.where(i), table.columns[column], "no finite number", "a finite number");
    const Pose X_BS{internal::rotation_at(table, i, 3), kMilli * internal::vector_at(table, i, 0)};
    if (!(X_BS.R.trace() > 1.0))
      throw InputError(table.where(i), "qw", "a rotation by 90 degrees or more", "a cup bent by less");
    Vector6 wrench;
    wrench << internal::vector_at(table, i, 7), kMilli * internal::vector_at(table, i, 10);
    poses.poses.push_back(X_BS);
    poses.wrenches.push_back(wrench);
  }
  if (poses.poses.empty()) throw InputError(name, "", "no rows", "one row for each pose");
  return poses;
}

CupPoses load_cup_poses(const std::filesystem::path& path) {
  return parse_cup_poses(read_file(path, "poses of a cup (CSV)"), path.string());
}

std::string format_pose_law(const PoseFit& fit, const std::string& note) {
  const PotentialLaw& law = fit.law;
  std::string text = "# " + note + "\nlaw:\n";
  text += fmt::format("  centre: {}  # m\n", numbers_text(law.centre_B.data(), 3));
  text += fmt::format("  reference: {}  # m\n", numbers_text(law.reference_B.data(), 3));
  text += fmt::format("  rest: {:.7g}  # m, along z\n", law.rest);
  text += fmt::format("  middle: {:.7g}  # m\n  half_range: {:.7g}  # m\n", law.middle, law.half_range);
  text += "  coefficients:\n";
  for (const Parameter& parameter : fit.parameters)
    text += fmt::format("    {}: {:.7g}  # +- {:.2g} {}, {}\n", parameter.name, parameter.value,
                        parameter.standard_error, parameter.unit, name_of(parameter.verdict));
  text += "  linear:  # on 1, p (m), rotation (rad): fx .. tz\n";
  for (Eigen::Index row = 0; row < 6; ++row) {
    const Eigen::Matrix<double, 7, 1> line = law.linear.row(row);
    text += fmt::format("    {}: {}\n",
                        std::vector<std::string>{"fx", "fy", "fz", "tx", "ty", "tz"}[static_cast<std::size_t>(row)],
                        numbers_text(line.data(), 7));
  }
  text += "cup:  # for scenarios, undeformed in the least compressed pose (docs/scenario.md, cup.law)\n";
  text += fmt::format("  centre_from_lip: {:.7g}  # m\n  law:\n", std::max(0.0, -law.centre_B.z()));
  model::CupLaw cup_law = cup_law_of(law);
  KeyWriter writer{text};
  cup_law.fields(writer);
  return text;
}

PotentialLaw load_pose_law(const std::filesystem::path& path) {
  const std::string name = path.string(), text = read_file(path, "a cup's law (YAML)");
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}:{}", name, error.mark.line + 1), "", error.msg, "YAML");
  }
  if (!root.IsMap() || !root["law"] || !root["law"].IsMap())
    throw InputError(name, "law", "nothing", "what `snug identify poses -o` writes");
  const YAML::Node node = root["law"];
  PotentialLaw law;
  law.centre_B = Vector3(law_numbers(node, "centre", 3, name).data());
  law.reference_B = Vector3(law_numbers(node, "reference", 3, name).data());
  law.rest = law_numbers(node, "rest", 1, name)[0];
  law.middle = law_numbers(node, "middle", 1, name)[0];
  law.half_range = law_numbers(node, "half_range", 1, name)[0];
  if (!(law.half_range > 0.0)) throw InputError(name, "law.half_range", "0 or less", "a number above 0");
  const YAML::Node coefficients = node["coefficients"], linear = node["linear"];
  if (!coefficients || !coefficients.IsMap()) throw InputError(name, "law.coefficients", "nothing", "a mapping");
  if (!linear || !linear.IsMap()) throw InputError(name, "law.linear", "nothing", "a mapping");
  const std::vector<std::string> names = coefficient_names();
  law.coefficients.resize(static_cast<Eigen::Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i)
    law.coefficients[static_cast<Eigen::Index>(i)] = law_numbers(coefficients, names[i], 1, name)[0];
  Eigen::Index row = 0;
  for (const char* component : {"fx", "fy", "fz", "tx", "ty", "tz"}) {
    const std::vector<double> line = law_numbers(linear, component, 7, name);
    for (Eigen::Index i = 0; i < 7; ++i) law.linear(row, i) = line[static_cast<std::size_t>(i)];
    ++row;
  }
  return law;
}

}  // namespace snug::identification
