#include "mbd_server/model/machines.hpp"

#include <algorithm>

namespace tandem::mbd {

std::vector<int> machine_of_links(const Model& model) {
  const std::size_t count = model.links.size();
  std::vector<LinkIndex> root(count);
  for (std::size_t i = 0; i < count; ++i) {
    const LinkIndex parent = model.links[i].parent;
    root[i] = i == 0 || parent <= 0 ? static_cast<LinkIndex>(i) : root[static_cast<std::size_t>(parent)];
  }
  // Each root refers to an earlier one of its machine, or to itself.
  const auto first = [&](LinkIndex i) {
    i = root[static_cast<std::size_t>(i)];
    while (root[static_cast<std::size_t>(i)] != i) i = root[static_cast<std::size_t>(i)];
    return i;
  };
  const auto join = [&](LinkIndex a, LinkIndex b) {
    a = first(a), b = first(b);
    if (a != 0 && b != 0) root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  };
  for (const Closure& c : model.closures) {
    join(c.a, c.b);
    for (const CoupledLink& term : c.terms) join(c.a, term.link);
  }
  std::vector<int> machine(count, none);
  for (std::size_t i = 1; i < count; ++i) machine[i] = static_cast<int>(first(static_cast<LinkIndex>(i)));
  return machine;
}

}  // namespace tandem::mbd
