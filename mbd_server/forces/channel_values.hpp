// The row of values of the machine elements over time (scene::element_columns()) that is filled in.
#pragma once

#include <array>
#include <vector>

#include "common/scene/element_columns.hpp"
#include "mbd_server/forces/energy_sums.hpp"
#include "mbd_server/model/indices.hpp"

namespace tandem::mbd {

// Columns of one element: the first of each channel, or none; and whether it is a force of the scene.
struct ElementAccount {
  std::array<int, static_cast<std::size_t>(scene::Channel::count)> first{};
  bool is_force = false;
};

class ChannelValues {
 public:
  ChannelValues(const std::vector<ElementAccount>& accounts, const EnergySums& sums, std::vector<double>& row)
      : accounts_(accounts), sums_(sums), row_(row) {}

  // Adds to the column, where the element has it.
  void add(int account, scene::Channel channel, double value, int part = 0) {
    if (account == none) return;
    const int first = accounts_[static_cast<std::size_t>(account)].first[static_cast<std::size_t>(channel)];
    if (first != none) row_[static_cast<std::size_t>(first + part)] += value;
  }
  // A force or torque on a coordinate and its rate.
  void add_effort(int account, bool rotates, double effort, double rate) {
    add(account, rotates ? scene::Channel::torque : scene::Channel::force, effort);
    add(account, rotates ? scene::Channel::speed : scene::Channel::velocity, rate);
    add(account, scene::Channel::power, effort * rate);
  }
  bool is_force(int account) const { return accounts_[static_cast<std::size_t>(account)].is_force; }
  // Energy that the element has lost since the start [J].
  double lost(int account) const { return sums_.lost_of[static_cast<std::size_t>(account)]; }

  double stored_at_start = 0;  // of the element that is observed [J]

 private:
  const std::vector<ElementAccount>& accounts_;
  const EnergySums& sums_;
  std::vector<double>& row_;
};

}  // namespace tandem::mbd
