// Where steps end: the first begin or end of a contact within a step, and the longest step that resolves the
// contacts. Reads candidates, gaps and points; changes nothing.
#pragma once

#include <optional>

#include "mbd_server/step/contact_candidates.hpp"

namespace tandem::mbd {

enum class ContactChange {
  begins,   // a contact
  returns,  // the shapes overlap within the step only
  ends,     // a contact
  follows   // another part of a mesh is nearest
};

struct ContactPassage {
  double time = 0;  // estimate, from the begin of the step [s]
  ContactChange change = ContactChange::begins;
  std::size_t candidate = 0;
};

struct ContactPassages {
  std::optional<ContactPassage> first;
  int pairs = 0;          // of shapes, with any
  double uncut_step = 0;  // that passes all of them without a cut [s]
};

// Estimates when a step of length h, between these gaps, passes the begins and ends of contacts at which it
// has to end.
ContactPassages find_passages(const ContactCandidates& candidates, const ContactRules& rules,
                              const std::vector<ContactPoint>& points, const ContactGaps& before,
                              const ContactGaps& after, double h);

// The search for the length of a step that ends at a passage: begins are found to the tolerance; a step may
// pass an end by a small share of its length.
class StepCut {
 public:
  StepCut(const ContactPassage& first, const ContactCandidates& candidates, const ContactRules& rules,
          double h, double time);

  double length() const { return part_; }  // of the step to take next [s]
  enum class Verdict { done, again, whole };
  // After that step, which took `taken`: whether it ends there; or is taken again, with the new length(); or
  // whole, because the shapes do not meet after all.
  Verdict look(double taken, const ContactGaps& gaps);

 private:
  const ContactPassage& first_;
  const ContactCandidates& candidates_;
  const ContactRules& rules_;
  double h_, time_, low_ = 0, high_, part_;
  int tries_ = 0;
};

// Longest step, of at most h, in which no shape passes through another one, and no body turns, rolls or spins
// by too much. `gaps`: at its begin.
double longest_step(const Model& model, const std::vector<LinkMotion>& links, const State& state,
                    const ContactCandidates& candidates, const ContactGaps& gaps, double h);

// Longest step that resolves the vibrations and impacts of a step of length h that began at `begin` [s]:
// those at its end, and those that ended so early in it that it was not cut there.
double resolving_step(const ContactRules& rules, const ContactLedger& ledger, const State& state,
                      double begin, double h);

}  // namespace tandem::mbd
