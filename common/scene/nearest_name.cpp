#include "common/scene/nearest_name.hpp"

#include <algorithm>

#include "common/utf8.hpp"

namespace tandem {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Rows i-2, i-1 and i of the table of distances between prefixes.
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before, last);
    std::swap(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

const std::string* nearest_name(std::string_view unknown, const std::vector<std::string>& names) {
  // A name that differs in more than a third of the word is not a typing error but another word.
  constexpr std::size_t longest_compared = 256;
  const std::string* nearest = nullptr;
  std::size_t nearest_distance = std::max<std::size_t>(1, unknown.size() / 3) + 1;
  for (const std::string& name : names) {
    if (unknown.size() > longest_compared || name.size() > longest_compared) continue;
    const std::size_t distance = edit_distance(unknown, name);
    // Names that share no character are no misspellings of each other.
    if (distance < nearest_distance && distance < std::max(unknown.size(), name.size())) {
      nearest = &name;
      nearest_distance = distance;
    }
  }
  return nearest;
}

std::string suggest_name(std::string_view unknown, const std::vector<std::string>& names,
                         std::string_view kind) {
  if (names.empty()) return "there are no " + std::string(kind);
  if (const std::string* nearest = nearest_name(unknown, names))
    return "did you mean '" + shortened(*nearest) + "'?";

  constexpr std::size_t longest_list = 12;
  std::string list = "known " + std::string(kind) + ": ";
  for (std::size_t i = 0; i < names.size() && i < longest_list; ++i)
    list += (i ? ", " : "") + shortened(names[i]);
  if (names.size() > longest_list) list += ", and " + std::to_string(names.size() - longest_list) + " more";
  return list;
}

}  // namespace tandem
