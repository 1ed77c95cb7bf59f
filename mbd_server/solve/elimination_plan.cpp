#include "mbd_server/solve/elimination_plan.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace tandem::mbd {
namespace {

class Planner {
 public:
  Planner(const Model& model, const std::vector<Connection>& connections, EliminationPlan& plan)
      : model_(model), connections_(connections), plan_(plan), neighbours_(connections.size()) {}

  void make() {
    plan_.links.resize(model_.links.size());
    plan_.connections.resize(connections_.size());
    for (int k = 0; k < std::ssize(connections_); ++k) activate(k);
    fill_sides();
    for (EliminationPlan::PerLink& link : plan_.links)
      for (const auto& a : link.active)
        for (const auto& b : link.active) {
          if (a.connection == b.connection || !a.depends || !b.acts) continue;
          neighbours_[a.connection].insert(b.connection);
          neighbours_[b.connection].insert(a.connection);
        }
    eliminate();
    place_blocks();
  }

 private:
  // Walks from both ends to the link where they meet. Links are numbered parent before child.
  void activate(int k) {
    const Connection& c = connections_[k];
    if (!c.more.empty() || c.by_neighbours) return activate_many(k);
    LinkIndex a = c.a, b = c.b;
    const auto descend = [&](LinkIndex& link, int side) {
      plan_.links[link].active.push_back({k, side, false, plan_.joint_blocks++});
      link = model_.links[link].parent;
    };
    while (a != b)
      if (a > b)
        descend(a, 0);
      else
        descend(b, 1);
    // A connection on the coordinates themselves is active on its own links in any case.
    if (c.direct && (a == c.a || a == c.b)) {
      descend(a, 0);
      plan_.links[c.a < c.b ? c.a : c.b].active.back().merges = true;
    }
    own_.emplace_back(a, k);
  }

  // The same for a connection of more than two links, whose branches meet at more than one link.
  void activate_many(int k) {
    const Connection& c = connections_[k];
    struct Head {
      LinkIndex link;
      int side;
      bool acts, depends;
    };
    std::vector<LinkIndex> own;
    std::vector<Head> heads;
    for (int side = 0; side < c.sides(); ++side) {
      own.push_back(c.link(side));
      heads.push_back({c.link(side), side, !c.by_neighbours || side == 0, !c.by_neighbours || side != 0});
    }
    while (true) {
      const LinkIndex link = std::max_element(heads.begin(), heads.end(), [](const Head& x, const Head& y) {
                               return x.link < y.link;
                             })->link;
      int into = none;
      bool acts = false, depends = false;
      std::erase_if(heads, [&](const Head& head) {
        if (head.link != link) return false;
        acts = acts || head.acts, depends = depends || head.depends;
        if (into == none) {
          into = head.side;  // sides ascend
          return false;
        }
        plan_.links[link].merges.push_back({k, head.side, into});
        return true;
      });
      const bool acts_here = c.direct && std::find(own.begin(), own.end(), link) != own.end();
      if (heads.size() == 1 && !acts_here) break;
      plan_.links[link].active.push_back({k, into, false, plan_.joint_blocks++, acts, depends});
      for (Head& head : heads)
        if (head.link == link) head = {model_.links[link].parent, head.side, acts, depends};
      if (heads.size() == 1) break;  // the last link of a direct connection
    }
    own_.emplace_back(heads.front().link, k);
  }

  // A connection that is eliminated at a moving link passes what acts on the link to those that it couples,
  // and what depends on it.
  void fill_sides() {
    std::vector<bool> full(model_.links.size(), false);
    for (const auto& [link, k] : own_) full[static_cast<std::size_t>(link)] = link > 0;
    for (std::size_t i = full.size(); i-- > 1;) {
      if (!full[i]) continue;
      for (auto& a : plan_.links[i].active) a.acts = a.depends = true;
      if (const LinkIndex parent = model_.links[i].parent; parent > 0) full[parent] = true;
    }
  }

  // Inward; at each link the connection with the fewest neighbours is first.
  void eliminate() {
    std::vector<std::vector<int>> at(model_.links.size());
    for (const auto& [link, k] : own_) at[link].push_back(k);
    std::vector<bool> gone(connections_.size(), false);
    for (std::size_t link = at.size(); link-- > 0;) {
      const std::set<int> here(at[link].begin(), at[link].end());
      std::set<std::pair<std::size_t, int>> queue;
      for (const int k : here) queue.emplace(neighbours_[k].size(), k);
      while (!queue.empty()) {
        const int k = queue.begin()->second;
        queue.erase(queue.begin());
        gone[k] = true;
        plan_.links[link].own.push_back(k);
        const std::vector<int> later(neighbours_[k].begin(), neighbours_[k].end());
        for (const int l : later) {
          const bool queued = here.count(l) > 0;
          if (queued) queue.erase({neighbours_[l].size(), l});
          neighbours_[l].erase(k);
          for (const int m : later)
            if (m != l) neighbours_[l].insert(m);
          if (queued) queue.emplace(neighbours_[l].size(), l);
          plan_.connections[k].later.push_back({l, side_of(link, l), 0, 0});
        }
      }
    }
  }

  int side_of(std::size_t link, int k) const {
    for (const auto& a : plan_.links[link].active)
      if (a.connection == k) return a.side;
    return 0;
  }

  void place_blocks() {
    std::map<std::pair<int, int>, int> place;
    const auto make = [&](int k, int l) {
      place[{k, l}] = plan_.values;
      plan_.values += connections_[k].size * connections_[l].size;
      return place[{k, l}];
    };
    for (int k = 0; k < std::ssize(connections_); ++k) {
      plan_.connections[k].diagonal = make(k, k);
      for (auto& n : plan_.connections[k].later) {
        n.row_block = make(k, n.connection);
        n.column_block = make(n.connection, k);
      }
    }
    for (auto& c : plan_.connections)
      for (const auto& l : c.later)
        for (const auto& m : c.later) c.updates.push_back(place.at({l.connection, m.connection}));
    for (auto& link : plan_.links)
      for (const auto& a : link.active)
        for (const auto& b : link.active)
          if (a.depends && b.acts) link.blocks.push_back(place.at({a.connection, b.connection}));
  }

  const Model& model_;
  const std::vector<Connection>& connections_;
  EliminationPlan& plan_;
  std::vector<std::pair<LinkIndex, int>> own_;
  std::vector<std::set<int>> neighbours_;  // of each connection, not yet eliminated
};

}  // namespace

EliminationPlan::EliminationPlan(const Model& model, const std::vector<Connection>& list) {
  Planner(model, list, *this).make();
}

}  // namespace tandem::mbd
