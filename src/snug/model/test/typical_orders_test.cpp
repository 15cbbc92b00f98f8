// Tests of typical orders: what is drawn can be packed, is the same for a seed, and mostly small.
#include "snug/model/typical_orders.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "snug/core/input_error.hpp"
#include "snug/model/items_file.hpp"

namespace snug::model {
namespace {

TEST(TypicalOrders, AreOrdersOfTheWantedSize) {
  const std::vector<OrderLine> lines = parse_orders_csv(draw_typical_orders({50, 20, 7}), "typical.csv");
  std::map<std::string, int> boxes;
  std::map<std::string, double> masses;
  double small = 0.0, all = 0.0;
  for (const OrderLine& line : lines) {
    boxes[line.order] += line.count;
    EXPECT_EQ(masses.try_emplace(line.article, line.mass).first->second, line.mass) << "one mass of an article";
    const double density = line.mass / line.size.prod();
    EXPECT_GT(density, 110.0) << line.article;
    EXPECT_LT(density, 360.0) << line.article;
    all += line.count;
    if (line.size.maxCoeff() < 0.19) small += line.count;
  }
  ASSERT_EQ(boxes.size(), 50U);
  for (const auto& [order, count] : boxes) {
    EXPECT_GE(count, 13) << order;
    EXPECT_LE(count, 27) << order;
  }
  EXPECT_NEAR(all / 50.0, 20.0, 2.0);
  EXPECT_NEAR(small / all, 0.543, 0.05) << "four of ten sizes: 0.4^(2/3)";
}

TEST(TypicalOrders, AreTheSameForASeed) {
  EXPECT_EQ(draw_typical_orders({3, 20, 1}), draw_typical_orders({3, 20, 1}));
  EXPECT_NE(draw_typical_orders({3, 20, 1}), draw_typical_orders({3, 20, 2}));
  EXPECT_EQ(draw_typical_orders({1, 1, 5}).find("order-2"), std::string::npos);
}

TEST(TypicalOrders, AreRefusedInOtherNumbers) {
  for (const TypicalOrders& wrong : {TypicalOrders{0, 20, 1}, TypicalOrders{101, 20, 1}, TypicalOrders{3, 0, 1},
                                     TypicalOrders{3, 201, 1}, TypicalOrders{-1, -1, 1}})
    EXPECT_THROW((void)draw_typical_orders(wrong), InputError);
}

}  // namespace
}  // namespace snug::model
