// The rules of the verdict, by their subject, in the order of the table in docs/verdict.md.
#pragma once

#include <vector>

#include "coordinator/verdict/verdict.hpp"

namespace tandem::launch {

void add_coupling_rules(std::vector<Rule>& table);  // energy, impulse and stability of the exchange
void add_mbd_rules(std::vector<Rule>& table);       // the multibody solver's own figures
void add_particle_rules(std::vector<Rule>& table);  // the particle solver's
void add_account_rules(std::vector<Rule>& table);   // what a participant says against what its data show
void add_liquid_rules(std::vector<Rule>& table);    // the liquid's

}  // namespace tandem::launch
