#include "common/scene/nearest_name.hpp"

#include <gtest/gtest.h>

namespace tandem {
namespace {

TEST(EditDistance, CountsEdits) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("glass", "glass"), 0u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("frition", "friction"), 1u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("masst", "mass"), 1u);
  EXPECT_EQ(edit_distance("mnad", "mand"), 1u) << "a swap of neighbours is one edit";
}

TEST(SuggestName, NearNameIsProposed) {
  EXPECT_EQ(suggest_name("gras", {"glass", "grass"}, "materials"), "did you mean 'grass'?");
  EXPECT_EQ(suggest_name("a", {"b", "c"}, "bodies"), "known bodies: b, c") << "no character is common";
}

TEST(SuggestName, FarNameGetsTheList) {
  EXPECT_EQ(suggest_name("water", {"glass", "steel"}, "materials"), "known materials: glass, steel");
  EXPECT_EQ(suggest_name("box", {}, "bodies"), "there are no bodies");
}

TEST(SuggestName, LongListsAreCut) {
  std::vector<std::string> names;
  for (int i = 0; i < 100; ++i) names.push_back("name" + std::to_string(i));
  EXPECT_EQ(suggest_name("xyz", names, "names"),
            "known names: name0, name1, name2, name3, name4, name5, name6, name7, name8, name9, name10, "
            "name11, and 88 "
            "more");
}

}  // namespace
}  // namespace tandem
