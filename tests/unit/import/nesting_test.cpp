#include "launch/import/nesting.hpp"

#include <gtest/gtest.h>

namespace tandem::launch {
namespace {

TEST(Nesting, CountsTheLevelsOfElements) {
  EXPECT_EQ(nesting_of("").deepest, 0u);
  EXPECT_EQ(nesting_of("no tags").deepest, 0u);
  EXPECT_EQ(nesting_of("<a/>").deepest, 0u) << "an element without a content has no level";
  EXPECT_EQ(nesting_of("<a></a><b></b>").deepest, 1u);
  EXPECT_EQ(nesting_of("<a>\n<b>\n<c></c></b><d></d></a>").deepest, 3u);
  EXPECT_EQ(nesting_of("<a>\n<b>\n<c></c></b><d></d></a>").line, 3u);
  EXPECT_EQ(nesting_of("</a></a><b>").deepest, 1u) << "there is no level below 0";
}

TEST(Nesting, KnowsWhatIsNoElement) {
  for (const char* text :
       {"<a><!-- <b><c> --></a>", "<a><![CDATA[<b><c>]]></a>", "<?xml version=\"1.0\"?><a></a>",
        "<!DOCTYPE a><a></a>", "<a b='/>' c=\"'>\"></a>", "<a><!-- > -- ' --></a>"}) {
    EXPECT_EQ(nesting_of(text).deepest, 1u) << text;
    EXPECT_EQ(nesting_of(text).fault, nullptr) << text;
  }
  // The "/>" is part of the value: the element stays open.
  EXPECT_EQ(nesting_of("<a b='/>'><a b='/>'><a b='/>'>").deepest, 3u);
}

// Texts in which the scan and a parser could see different tags.
TEST(Nesting, RefusesTagsWithoutAnEnd) {
  for (const char* text : {"<", "<a", "<a <b>", "<a b='<!--'>", "<?xml version=\"><!--\"?>", "<a b='>",
                           "<!-- ", "<![CDATA[ ]>", "<!DOCTYPE a [<!ENTITY b 'c'>]>"})
    EXPECT_NE(nesting_of(text).fault, nullptr) << text;
}

}  // namespace
}  // namespace tandem::launch
