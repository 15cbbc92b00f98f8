// Row clusters: what lies around unsolved rows, in parts that share no body, and how large they may be.
#include "snug/physics/internal/row_clusters.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "snug/physics/internal/contact_system.hpp"

namespace snug::physics::internal {
namespace {

/// Bodies in a row, each on the next, one contact a pair; all bear. Two contacts far apart are not solved.
struct Chain {
  static constexpr int kBodies = 40, kUnsolved[] = {9, 29};

  std::vector<Row> rows{kBodies - 1};
  std::vector<NewtonRow> newton{kBodies - 1};
  std::vector<RowPatch> patches{kBodies - 1};
  RowClusters clusters{kBodies, kBodies - 1};

  Chain() {
    for (int i = 0; i < kBodies - 1; ++i) {
      const auto k = static_cast<std::size_t>(i);
      patches[k].first = i, patches[k].count = 1, patches[k].ia = i, patches[k].ib = i + 1;
      rows[k].ia = i, rows[k].ib = i + 1;
      rows[k].lambda[0] = 1.0 + i;
      newton[k].residual = 0.0;
    }
    for (const int i : kUnsolved) newton[static_cast<std::size_t>(i)].residual = 1.0;
  }
  [[nodiscard]] bool find(int rings, std::size_t most) {
    return clusters.find(rows.data(), newton.data(), patches, 0.5, rings, most, nullptr);
  }
  [[nodiscard]] bool find_growing(const RowClusters::Limits& most) {
    return clusters.find_growing(rows.data(), newton.data(), patches, 0.5, most, nullptr);
  }
};

TEST(RowClusters, AreTheUnsolvedWithRingsOfNeighbours) {
  Chain chain;
  for (int rings = 0; rings < 9; ++rings) {
    ASSERT_TRUE(chain.find(rings, 39));
    ASSERT_EQ(chain.clusters.count(), 2U) << rings;
    for (std::size_t i = 0; i < 2; ++i) {
      const std::span<Row> cluster = chain.clusters[i];
      ASSERT_EQ(cluster.size(), static_cast<std::size_t>(1 + 2 * rings));
      EXPECT_EQ(cluster.front().ia, Chain::kUnsolved[i] - rings);
    }
  }
  ASSERT_TRUE(chain.find(9, 39));
  EXPECT_EQ(chain.clusters.count(), 1U) << "they meet";
}

TEST(RowClusters, AreNoLargerThanAsked) {
  Chain chain;
  EXPECT_TRUE(chain.find(3, 14));
  EXPECT_FALSE(chain.find(3, 13)) << "fourteen rows in all";
}

TEST(RowClusters, GrowWhereTheyAreFoundAgain) {
  Chain chain;
  for (std::size_t rings = 1; rings < 6; ++rings) {
    ASSERT_TRUE(chain.find_growing({39, 39}));
    ASSERT_EQ(chain.clusters.count(), 2U) << rings;
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(chain.clusters[i].size(), 1 + 2 * rings);
  }
  chain.clusters.forget();
  ASSERT_TRUE(chain.find_growing({39, 39}));
  EXPECT_EQ(chain.clusters[0].size(), 3U);
}

TEST(RowClusters, GrowAloneAndGoOnWhereTheRestWas) {
  Chain chain;
  ASSERT_TRUE(chain.find_growing({39, 39}));
  ASSERT_TRUE(chain.find_growing({39, 39}));
  // The first is solved. What is left of the second has moved to its rim.
  chain.newton[9].residual = chain.newton[29].residual = 0.0;
  chain.newton[31].residual = chain.newton[3].residual = 1.0;
  ASSERT_TRUE(chain.find_growing({39, 39}));
  ASSERT_EQ(chain.clusters.count(), 2U);
  EXPECT_EQ(chain.clusters[0].size(), 3U) << "for the first time";
  EXPECT_EQ(chain.clusters[1].size(), 7U) << "for the third time";
}

TEST(RowClusters, HaveFewerRingsWhereTheyWouldBeTooLarge) {
  Chain chain;
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(chain.find_growing({39, 6}));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(chain.clusters[i].size(), 5U) << "six are none";
  ASSERT_TRUE(chain.find_growing({9, 39}));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(chain.clusters[i].size(), 3U) << "ten in all are too many";
  EXPECT_TRUE(chain.find_growing({2, 1}));
  EXPECT_FALSE(chain.find_growing({1, 39})) << "there are two without any ring";
}

TEST(RowClusters, PutBackTheirImpulsesAlone) {
  Chain chain;
  ASSERT_TRUE(chain.find(1, 39));
  for (std::size_t i = 0; i < 2; ++i) {
    for (Row& row : chain.clusters[i]) row.lambda[0] = -1.0;
  }
  chain.clusters.put_back(chain.rows.data());
  for (int i = 0; i < Chain::kBodies - 1; ++i) {
    const bool is_near = (i >= 8 && i <= 10) || (i >= 28 && i <= 30);
    EXPECT_EQ(chain.rows[static_cast<std::size_t>(i)].lambda[0], is_near ? -1.0 : 1.0 + i) << i;
  }
}

}  // namespace
}  // namespace snug::physics::internal
