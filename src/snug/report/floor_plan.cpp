// FloorPlan: what stands in a cell, from above, with what a robot reaches.
#include "snug/report/floor_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "snug/report/escape.hpp"
#include "snug/report/internal/raw.hpp"
#include "snug/report/internal/svg.hpp"

namespace snug::report {
namespace {

constexpr double kDrawingWidth = 620.0, kDrawingMargin = 14.0, kTallest = 620.0;

/// Places of the drawing.
class Scale {
 public:
  explicit Scale(const FloorPlan& plan) {
    const auto include = [&](const Eigen::Vector2d& p, double radius) {
      low_ = low_.cwiseMin((p.array() - radius).matrix());
      high_ = high_.cwiseMax((p.array() + radius).matrix());
    };
    for (const PlanOutline& one : plan.outlines)
      for (const Eigen::Vector2d& p : one.corners) include(p, 0.0);
    for (const PlanCircle& one : plan.circles) include(one.middle, one.radius);
    for (const PlanDot& one : plan.dots) include(one.at, 0.0);
    if (!(low_.x() < high_.x() && low_.y() < high_.y())) high_ = (low_ = Eigen::Vector2d::Zero()).array() + 1.0;
    per_metre_ = std::min((kDrawingWidth - 2.0 * kDrawingMargin) / (high_ - low_).x(),
                          (kTallest - 2.0 * kDrawingMargin) / (high_ - low_).y());
  }
  [[nodiscard]] double x(const Eigen::Vector2d& p) const { return kDrawingMargin + per_metre_ * (p - low_).x(); }
  [[nodiscard]] double y(const Eigen::Vector2d& p) const { return kDrawingMargin + per_metre_ * (high_ - p).y(); }
  [[nodiscard]] double per_metre() const { return per_metre_; }
  [[nodiscard]] double width() const { return 2.0 * kDrawingMargin + per_metre_ * (high_ - low_).x(); }
  [[nodiscard]] double height() const { return 2.0 * kDrawingMargin + per_metre_ * (high_ - low_).y(); }

 private:
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), high_ = -low_;
  double per_metre_ = 1.0;
};

const char* style_of(PlanInk ink) {
  static constexpr std::array kStyles = {"class=\"floor\"", "class=\"thing\"", "class=\"robot\"", "class=\"dot\"",
                                         "class=\"unreached\""};
  return kStyles[static_cast<std::size_t>(ink)];
}

}  // namespace

Markup floor_plan(const FloorPlan& plan) {
  const Scale scale(plan);
  std::string svg, labels;
  for (const PlanOutline& one : plan.outlines) {
    std::string points;
    double middle = 0.0, top = scale.height();
    for (const Eigen::Vector2d& p : one.corners) {
      points += fmt::format("{:.1f},{:.1f} ", scale.x(p), scale.y(p));
      middle += scale.x(p) / static_cast<double>(one.corners.size());
      top = std::min(top, scale.y(p));
    }
    svg += fmt::format("<polygon points=\"{}\" {}><title>{}</title></polygon>\n", points, style_of(one.ink),
                       escape(one.name));
    if (one.is_labelled) labels += internal::svg_text(middle, top - 4.0, one.name, "middle");
  }
  for (const PlanCircle& one : plan.circles)
    svg += internal::svg_dot(scale.x(one.middle), scale.y(one.middle), scale.per_metre() * one.radius,
                             "class=\"reach\"", one.about);
  for (const PlanDot& one : plan.dots)
    svg += internal::svg_dot(scale.x(one.at), scale.y(one.at), 2.0, style_of(one.ink), one.about);
  constexpr double kBar = 0.5;  // m
  const double left = kDrawingMargin, bottom = scale.height() - 6.0;
  svg += internal::svg_line(left, bottom, left + kBar * scale.per_metre(), bottom, "class=\"bar\"");
  svg += labels + internal::svg_text(left + kBar * scale.per_metre() + 5.0, bottom + 3.0, "0.5 m", "start");
  return internal::Raw::of(internal::svg_drawing(scale.width(), scale.height(), plan.about, svg));
}

}  // namespace snug::report
