#include "coordinator/report/wireframe.hpp"

#include <gtest/gtest.h>

namespace tandem::launch {
namespace {

TEST(Wireframe, BoxHasTwelveEdges) {
  EXPECT_EQ(feature_edges(box_mesh({1, 2, 3})).size(), 12u);
  EXPECT_EQ(feature_edges(box_mesh({1, 2, 3}, {"+z"})).size(), 12u) << "the rim of an open box is drawn";
}

TEST(Wireframe, SmoothSideOfACylinderIsNotDrawn) {
  EXPECT_EQ(feature_edges(cylinder_mesh(1, 2, 48)).size(), 2 * 48u) << "its two circles";
  EXPECT_EQ(feature_edges(cylinder_mesh(1, 2, 4)).size(), 12u) << "four corners make a box";
}

}  // namespace
}  // namespace tandem::launch
