// Calibration: which motion counts in which bin.
#include "snug/study/calibration.hpp"

#include <gtest/gtest.h>

#include <string>

namespace snug::study {
namespace {

/// An item with motions of these predictions, of which the last one succeeds.
void add_item(Trial& trial, const std::vector<double>& predicted, int samples) {
  session::ItemReport report;
  report.id = "item " + std::to_string(trial.session.items.size());
  report.samples = samples;
  TrueItem item;
  item.id = report.id;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    session::Send send;
    send.predicted_success = predicted[i];
    report.sends.push_back(send);
    item.succeeded.push_back(i + 1 == predicted.size());
  }
  trial.session.items.push_back(report);
  trial.items.push_back(item);
}

TEST(Calibration, ItemsThatWereLeftOutOnPaperHaveNoPlaceInIt) {
  Trial trial;
  add_item(trial, {}, 8);
  trial.items.clear();
  add_item(trial, {0.95, 0.95}, 8);
  Calibration found;
  found.add(trial);
  EXPECT_EQ(found.bins[9].motions, 2);
  EXPECT_EQ(found.bins[9].succeeded, 1);
}

TEST(Calibration, CountsEachMotionInTheBinOfItsPrediction) {
  Trial trial;
  add_item(trial, {0.95, 1.0}, 8);
  add_item(trial, {0.3, 0.0}, 8);
  add_item(trial, {0.95}, 0);  // not rehearsed in samples
  add_item(trial, {}, 8);      // not sent
  Calibration found;
  found.add(trial);
  EXPECT_EQ(found.bins[9].motions, 2) << "1 belongs to the last bin";
  EXPECT_EQ(found.bins[9].succeeded, 1);
  EXPECT_DOUBLE_EQ(found.bins[9].predicted, 1.95);
  EXPECT_EQ(found.bins[3].motions, 1) << "a bin has its lower bound";
  EXPECT_EQ(found.bins[0].succeeded, 1);
  Calibration twice = found;
  twice.add(found);
  EXPECT_EQ(twice.bins[9].motions, 4);
  EXPECT_EQ(twice.bins[9].succeeded, 2);
}

}  // namespace
}  // namespace snug::study
