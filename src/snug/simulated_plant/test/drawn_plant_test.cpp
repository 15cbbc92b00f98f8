// draw_plant: every quantity of a drawn cell has the distribution that the scenario's uncertainty states.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/simulated_plant/test/demo_rows.hpp"

namespace snug::simulated_plant {
namespace {

/// Everything that can be drawn is there: soft travel and a clearance, too.
const model::Scenario& uncertain() {
  static const model::Scenario one = [] {
    model::Scenario scenario = test::three_boxes();
    scenario.uncertainty = model::Uncertainty{};
    scenario.parcel_clearance = 0.002;
    scenario.contact_pairs.front().params.travel = 1e-3;
    return cell::with_fixed_arrivals(scenario, "1");
  }();
  return one;
}

/// A number of a drawn cell, uniform within `half_width` around `middle`.
struct Quantity {
  const char* name;
  std::function<double(const model::Scenario&)> of;
  double middle, half_width;
};

const model::Item& first_item(const model::Scenario& scenario) { return scenario.sequences.front().items.front(); }

Pose aligner_off(const model::Scenario& drawn) { return uncertain().aligner->X_WA.inverse() * drawn.aligner->X_WA; }

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all = [] {
    const model::Scenario& was = uncertain();
    const model::Uncertainty& u = was.uncertainty;
    const auto share = [](double is, double before) { return is / before - 1.0; };
    return std::vector<Quantity>{
        {"mass of the first box",
         [=](const auto& s) { return share(s.parcels[0].inertia.mass, uncertain().parcels[0].inertia.mass); }, 0.0,
         u.mass},
        {"mass of the second box",
         [=](const auto& s) { return share(s.parcels[1].inertia.mass, uncertain().parcels[1].inertia.mass); }, 0.0,
         u.mass},
        {"centre of mass, x", [](const auto& s) { return s.parcels[0].inertia.com.x(); }, 0.0, u.com},
        {"centre of mass, z", [](const auto& s) { return s.parcels[0].inertia.com.z(); },
         was.parcels[0].inertia.com.z(), u.com},
        {"friction of the first pair",
         [=](const auto& s) {
           return share(s.contact_pairs[0].params.friction, uncertain().contact_pairs[0].params.friction);
         },
         0.0, u.friction},
        {"friction of the second pair",
         [=](const auto& s) {
           return share(s.contact_pairs[1].params.friction, uncertain().contact_pairs[1].params.friction);
         },
         0.0, u.friction},
        {"contact stiffness",
         [=](const auto& s) {
           return share(*s.contact_pairs[0].params.stiffness, *uncertain().contact_pairs[0].params.stiffness);
         },
         0.0, u.contact_stiffness},
        {"soft travel", [=](const auto& s) { return share(*s.contact_pairs[0].params.travel, 1e-3); }, 0.0,
         u.contact_travel},
        {"clearance", [](const auto& s) { return s.parcel_clearance; }, 0.002, u.clearance},
        {"arrival along Ax", [](const auto& s) { return first_item(s).shift_A.x(); }, first_item(was).shift_A.x(),
         u.position},
        {"arrival along Ay", [](const auto& s) { return first_item(s).shift_A.y(); }, first_item(was).shift_A.y(),
         u.position},
        {"turn at arrival", [](const auto& s) { return first_item(s).turn; }, first_item(was).turn, u.yaw},
        {"aligner along Ax", [](const auto& s) { return aligner_off(s).p.x(); }, 0.0, u.aligner_position},
        {"aligner along Ay", [](const auto& s) { return aligner_off(s).p.y(); }, 0.0, u.aligner_position},
        {"yaw of the aligner", [](const auto& s) { return log_rotation(aligner_off(s).R).z(); }, 0.0, u.aligner_yaw},
        {"stiffness of the cup",
         [=](const auto& s) { return share(s.cup.stiffness.axial, uncertain().cup.stiffness.axial); }, 0.0,
         u.cup_stiffness},
        {"damping of the cup", [=](const auto& s) { return share(s.cup.damping.bend, uncertain().cup.damping.bend); },
         0.0, u.cup_stiffness},
        {"length of the cup", [](const auto& s) { return s.cup.hold_length; }, was.cup.hold_length, u.cup_length},
        {"push at release", [](const auto& s) { return s.cup.release_push; }, 0.5, 0.5},  // from none to all
        {"lag",
         [=](const auto& s) { return share(s.controller.task_stiffness, uncertain().controller.task_stiffness); }, 0.0,
         u.tracking},
    };
  }();
  return all;
}

constexpr int kPlants = 1500;

/// One column for each quantity, one row for each plant: 0 in the middle, -1 and 1 at the ends of the range.
const Eigen::MatrixXd& draws() {
  static const Eigen::MatrixXd all = [] {
    Eigen::MatrixXd found(kPlants, static_cast<Eigen::Index>(quantities().size()));
    for (int plant = 0; plant < kPlants; ++plant) {
      const model::Scenario drawn = draw_plant(uncertain(), "1", static_cast<std::uint64_t>(plant) + 1);
      for (std::size_t i = 0; i < quantities().size(); ++i) {
        const Quantity& one = quantities()[i];
        found(plant, static_cast<Eigen::Index>(i)) = (one.of(drawn) - one.middle) / one.half_width;
      }
    }
    return found;
  }();
  return all;
}

// Of N uniform draws in [-1, 1] the mean has a deviation of 1 / sqrt(3 N), the variance of sqrt(0.8 / N) times itself,
// a correlation of 1 / sqrt(N). Five of them are never met by chance; the seeds are fixed besides.
const double kFive = 5.0 / std::sqrt(static_cast<double>(kPlants));

TEST(DrawPlant, EveryQuantityIsUniformOverItsStatedRange) {
  for (std::size_t i = 0; i < quantities().size(); ++i) {
    SCOPED_TRACE(quantities()[i].name);
    const Eigen::VectorXd x = draws().col(static_cast<Eigen::Index>(i));
    EXPECT_LE(x.cwiseAbs().maxCoeff(), 1.0 + 1e-9);
    EXPECT_GT(x.maxCoeff(), 0.98) << "the range is used to its end";
    EXPECT_LT(x.minCoeff(), -0.98);
    EXPECT_NEAR(x.mean(), 0.0, kFive / std::sqrt(3.0));
    EXPECT_NEAR(3.0 * x.squaredNorm() / kPlants, 1.0, kFive * std::sqrt(0.8));
    const double fourth = x.array().pow(4).mean();  // 1/5; its deviation is sqrt((1/9 - 1/25) / N)
    EXPECT_NEAR(fourth, 0.2, kFive * std::sqrt(1.0 / 9.0 - 1.0 / 25.0));
  }
}

TEST(DrawPlant, NoQuantitySaysAnythingOfAnother) {
  for (Eigen::Index a = 0; a < draws().cols(); ++a) {
    for (Eigen::Index b = 0; b < a; ++b) {
      EXPECT_NEAR(3.0 * draws().col(a).dot(draws().col(b)) / kPlants, 0.0, kFive)
          << quantities()[static_cast<std::size_t>(a)].name << ", " << quantities()[static_cast<std::size_t>(b)].name;
    }
  }
}

TEST(DrawPlant, NeighbouringSeedsSayNothingOfEachOther) {
  for (Eigen::Index i = 0; i < draws().cols(); ++i) {
    EXPECT_NEAR(3.0 * draws().col(i).head(kPlants - 1).dot(draws().col(i).tail(kPlants - 1)) / kPlants, 0.0, kFive)
        << quantities()[static_cast<std::size_t>(i)].name;
  }
}

TEST(DrawPlant, SizesGrowTogetherAndEachEdgeByItself) {
  model::Scenario together = uncertain(), alone = uncertain();
  together.uncertainty.size = 0.0;
  alone.uncertainty.size_common = 0.0;
  double sum = 0.0, least = 1.0, most = -1.0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const model::Scenario grown = draw_plant(together, "1", seed), other = draw_plant(alone, "1", seed);
    const double share = grown.parcels[0].size.x() / together.parcels[0].size.x() - 1.0;
    least = std::min(least, share), most = std::max(most, share);
    for (std::size_t i = 0; i < grown.parcels.size(); ++i) {
      EXPECT_TRUE(grown.parcels[i].size.isApprox((1.0 + share) * together.parcels[i].size, 1e-12));
      EXPECT_LE((other.parcels[i].size - alone.parcels[i].size).cwiseAbs().maxCoeff(), alone.uncertainty.size + 1e-12);
    }
    sum += (other.parcels[0].size - alone.parcels[0].size).x() * (other.parcels[0].size - alone.parcels[0].size).y();
  }
  EXPECT_NEAR(most, together.uncertainty.size_common, 0.02 * together.uncertainty.size_common);
  EXPECT_NEAR(least, -together.uncertainty.size_common, 0.02 * together.uncertainty.size_common);
  const double variance = alone.uncertainty.size * alone.uncertainty.size / 3.0;
  EXPECT_LT(std::abs(sum) / 300.0, 5.0 / std::sqrt(300.0) * variance) << "two edges of one box";
}

TEST(DrawPlant, DrawsTheFactorsOfAWholeCellOnce) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const model::Scenario drawn = draw_plant(uncertain(), "1", seed);
    const double stiffer = *drawn.contact_pairs[0].params.stiffness / *uncertain().contact_pairs[0].params.stiffness;
    for (std::size_t i = 0; i < drawn.contact_pairs.size(); ++i) {
      if (!uncertain().contact_pairs[i].params.stiffness) continue;
      EXPECT_NEAR(*drawn.contact_pairs[i].params.stiffness / *uncertain().contact_pairs[i].params.stiffness, stiffer,
                  1e-12);
    }
    const model::CupElasticity &is = drawn.cup.stiffness, &was = uncertain().cup.stiffness;
    for (const auto part : {&model::CupElasticity::lateral, &model::CupElasticity::bend, &model::CupElasticity::torsion,
                            &model::CupElasticity::coupling}) {
      EXPECT_NEAR(is.*part * was.axial, was.*part * is.axial, 1e-12 * is.axial * was.axial);
    }
    const model::Parcel &box = drawn.parcels[0], &nominal = uncertain().parcels[0];
    EXPECT_TRUE(
        (box.inertia.inertia / box.inertia.mass).isApprox(nominal.inertia.inertia / nominal.inertia.mass, 1e-12))
        << "a heavier box is harder to turn by as much";
  }
}

TEST(DrawPlant, NothingIsDrawnWhereNothingIsUncertain) {
  model::Scenario scenario = test::three_boxes();
  scenario.uncertainty = model::no_uncertainty();
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    EXPECT_EQ(draw_plant(scenario, "1", seed), cell::with_fixed_arrivals(scenario, "1")) << seed;
  }
}

/// Each width alone set to nothing: that quantity is what the scenario says, and no other draw changes.
TEST(DrawPlant, AWidthOfNothingStopsItsOwnDrawAlone) {
  using model::Uncertainty;
  const std::vector<std::pair<double Uncertainty::*, std::vector<std::string>>> widths{
      {&Uncertainty::mass, {"mass of the first box", "mass of the second box"}},
      {&Uncertainty::com, {"centre of mass, x", "centre of mass, z"}},
      {&Uncertainty::friction, {"friction of the first pair", "friction of the second pair"}},
      {&Uncertainty::contact_stiffness, {"contact stiffness"}},
      {&Uncertainty::contact_travel, {"soft travel"}},
      {&Uncertainty::clearance, {"clearance"}},
      {&Uncertainty::position, {"arrival along Ax", "arrival along Ay"}},
      {&Uncertainty::yaw, {"turn at arrival"}},
      {&Uncertainty::aligner_yaw, {"yaw of the aligner"}},
      {&Uncertainty::cup_length, {"length of the cup"}},
      {&Uncertainty::cup_stiffness, {"stiffness of the cup", "damping of the cup"}},
      {&Uncertainty::tracking, {"lag"}}};
  const model::Scenario all = draw_plant(uncertain(), "1", 5);
  for (const auto& [width, names] : widths) {
    model::Scenario scenario = uncertain();
    scenario.uncertainty.*width = 0.0;
    const model::Scenario drawn = draw_plant(scenario, "1", 5);
    for (const Quantity& one : quantities()) {
      const bool is_its = std::ranges::find(names, one.name) != names.end();
      EXPECT_NEAR(one.of(drawn), is_its ? one.middle : one.of(all), 1e-12) << one.name << " without " << names.front();
    }
  }
}

TEST(DrawPlant, NeverMakesABoxWithoutSizeOrAMassThatIsNotPositive) {
  model::Scenario scenario = test::three_boxes();
  scenario.uncertainty.size = 10.0;
  scenario.uncertainty.com = 10.0;
  scenario.uncertainty.mass = scenario.uncertainty.friction = scenario.uncertainty.size_common = 1.0;
  scenario.uncertainty.contact_stiffness = scenario.uncertainty.cup_stiffness = scenario.uncertainty.tracking = 1.0;
  scenario.uncertainty.clearance = 1.0;
  scenario.uncertainty.cup_length = 1.0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const model::Scenario drawn = draw_plant(scenario, "1", seed);
    for (std::size_t i = 0; i < drawn.parcels.size(); ++i) {
      const model::Parcel& box = drawn.parcels[i];
      EXPECT_GE((box.size - 0.5 * scenario.parcels[i].size).minCoeff(), 0.0);
      EXPECT_LE((box.inertia.com.cwiseAbs() - 0.45 * box.size).maxCoeff(), 1e-12) << "inside of the box";
      EXPECT_GT(box.inertia.mass, 0.0);
    }
    EXPECT_GE(drawn.parcel_clearance, 0.0);
    EXPECT_GT(drawn.cup.stiffness.axial, 0.0);
    EXPECT_GE(drawn.cup.hold_length, drawn.cup.centre_from_lip);
    EXPECT_GT(drawn.controller.task_stiffness, 0.0);
    for (const model::ContactPair& pair : drawn.contact_pairs) EXPECT_GT(pair.params.friction, 0.0);
  }
}

}  // namespace
}  // namespace snug::simulated_plant
