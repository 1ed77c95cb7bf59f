// Signals of a run against those of a model: a table of the peaks, the largest deviation and its tolerance.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::mbd {

class Comparison {
 public:
  explicit Comparison(std::string title) : title_(std::move(title)) {}

  std::size_t rows() const { return rows_.size(); }
  // A signal; the tolerance is a share of its largest expected value.
  void add(std::string name, double tolerance) { rows_.push_back({std::move(name), tolerance}); }
  // Its expected and its measured value at one instant.
  void at(std::size_t row, double expected, double measured) {
    Row& r = rows_.at(row);
    if (std::abs(expected) >= std::abs(r.expected)) r.expected = expected, r.measured = measured;
    // A value that is no number is the largest deviation.
    const double off = std::abs(measured - expected);
    if (!std::isnan(r.deviation) && !(off <= r.deviation)) r.deviation = off;
    ++r.instants;
  }

  // Prints the table; every deviation must be within its tolerance.
  void expect() const {
    std::printf("%s\n%-40s %14s %14s %12s %12s\n", title_.c_str(), "", "expected peak", "measured",
                "deviation", "tolerance");
    for (const Row& r : rows_) {
      const double allowed = r.tolerance * std::abs(r.expected);
      std::printf("%-40s %14.7g %14.7g %12.2e %12.2e\n", r.name.c_str(), r.expected, r.measured, r.deviation,
                  allowed);
      EXPECT_GT(r.instants, 0) << r.name;
      EXPECT_LE(r.deviation, allowed) << title_ << ": " << r.name;
    }
  }

 private:
  struct Row {
    std::string name;
    double tolerance;
    double expected = 0, measured = 0, deviation = 0;
    int instants = 0;
  };
  std::string title_;
  std::vector<Row> rows_;
};

// The expected values of the scene's checks, in their order, are these figures of a model ("column reduce",
// value).
inline void expect_figures_of_checks(const scene::Scene& scene,
                                     const std::vector<std::pair<std::string, double>>& figures) {
  ASSERT_EQ(scene.checks.size(), figures.size());
  std::printf("%-40s %14s %14s\n", "checks of the scene", "model", "scene");
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const scene::Check& check = scene.checks[i];
    std::printf("%-40s %14.7g %14.7g\n", figures[i].first.c_str(), figures[i].second, check.expected);
    EXPECT_EQ(check.of + " " + check.reduce, figures[i].first);
    EXPECT_NEAR(check.expected, figures[i].second, 1e-5 * std::abs(check.expected));
  }
}

}  // namespace tandem::mbd
