// Features that touch or may touch within a step, and which of them continue points in contact. Changes the
// features of the points, and drops points; enters none.
#pragma once

#include <compare>
#include <optional>
#include <span>
#include <vector>

#include "mbd_server/contact/point_matches.hpp"
#include "mbd_server/step/contact_ledger.hpp"
#include "mbd_server/step/contact_rules.hpp"

namespace tandem::mbd {

// Distance of the shapes at a feature [m], [m/s].
struct ContactGap {
  double value = 0, rate = 0;
  // Of a ball that touches a mesh: the distance of what is nearest to it now less that of the feature that
  // the step holds [m], and since when these differ [s].
  double off = 0, since = 0;
};
using ContactGaps = std::vector<ContactGap>;  // (candidates)

// A feature that touches or may touch within the step.
struct ContactCandidate {
  ContactFeature feature;
  Eigen::Index point = -1;  // of State::contacts; -1: it does not touch
  double tolerance = 0;     // of its gap [m]
};

// A ball near a mesh: its `watch` and the features with which it touches.
struct BallWatch {
  std::size_t candidate = 0;
  std::vector<std::size_t> held{};     // candidates
  double reach = 0, depth = 0;         // [m]
  Vector3d centre = Vector3d::Zero();  // of the ball at the begin of the step, in the frame of the mesh [m]
};

class ContactCandidates {
 public:
  ContactCandidates(const Model& model, const ContactRules& rules, ContactLedger& ledger)
      : model_(model), rules_(rules), ledger_(ledger) {}

  // Finds the features that may touch within h. Those that touch keep their points; points that are no longer
  // features are dropped.
  void find(const std::vector<LinkMotion>& links, double h, std::vector<ContactPoint>& points);
  // Drops all points but these, and keeps their order.
  void keep(std::vector<ContactPoint>& points, std::vector<Eigen::Index> kept);
  void measure(const std::vector<LinkMotion>& links, ContactGaps& gaps);

  std::vector<ContactCandidate>& all() { return all_; }
  const std::vector<ContactCandidate>& all() const { return all_; }
  const ContactCandidate& operator[](std::size_t i) const { return all_[i]; }
  std::size_t size() const { return all_.size(); }
  // Pairs of shapes that are near.
  const std::vector<NearPair>& pairs() const { return pairs_; }
  // Longest step after a ball has come to another part of a mesh, with another normal, in the last find();
  // none: no ball has [s].
  std::optional<double> turned() const { return turned_; }

  // Balls on meshes (contacts_on_meshes.cpp). Notes where they are at the begin of the step.
  void mark_balls(const std::vector<LinkMotion>& links);
  // Whether the centre of a ball has gone through a face in the step, although nothing presses it so deep.
  bool went_through(const std::vector<LinkMotion>& links, const ContactGaps& gaps) const;
  // Calls enter(candidate, rate) for what a ball begins to touch.
  template <class F>
  void enter_watched(const std::vector<LinkMotion>& links, bool at_start, F&& enter) {
    for (BallWatch& watch : watches_) {
      find_beginning(links, watch, at_start);
      for (const auto& [feature, rate] : beginning_) {
        watch.held.push_back(all_.size());
        all_.push_back({feature, -1, rules_.tolerance(feature)});
        enter(all_.size() - 1, rate);
      }
    }
  }
  // Throws where a corner or an edge comes through the flat end of a cylinder.
  void expect_round_side(const ContactFeature& f, double gap) const;

 private:
  // A point in contact of a pair of shapes.
  struct OfPair {
    ShapePair pair;
    Eigen::Index point;
    auto operator<=>(const OfPair&) const = default;
  };
  using Range = std::span<const OfPair>;
  struct Beginning {
    ContactFeature feature;
    double rate;
  };

  Range of_pair(const ShapePair& pair) const;
  void match(const std::vector<LinkMotion>& links, const std::vector<ContactPoint>& points, Range of_pair);
  void follow(const std::vector<LinkMotion>& links, const ContactFeature& feature, ContactPoint& point);
  double same_foot(const ContactFeature& feature) const;
  void measure_watch(const std::vector<LinkMotion>& links, const std::vector<ContactFeature>& found,
                     ContactGap& gap) const;
  std::optional<ContactFeature> uncovered(const std::vector<LinkMotion>& links, const BallWatch& watch,
                                          std::vector<ContactFeature>& found, ContactGaps* gaps) const;
  void find_beginning(const std::vector<LinkMotion>& links, const BallWatch& watch, bool at_start);
  void expect_in_front(const std::vector<LinkMotion>& links, const ContactFeature& back, bool at_start) const;
  [[noreturn]] void fail_from_behind(const std::vector<LinkMotion>& links, const ContactFeature& feature,
                                     bool at_start) const;
  Vector3d on_mesh(const std::vector<LinkMotion>& links, const ContactFeature& watch) const;

  const Model& model_;
  const ContactRules& rules_;
  ContactLedger& ledger_;
  std::vector<NearPair> pairs_;
  std::vector<ContactFeature> features_;
  std::vector<ContactCandidate> all_;
  std::vector<BallWatch> watches_;
  std::vector<Beginning> beginning_;
  std::optional<double> turned_;
  std::vector<OfPair> by_pair_;
  PointMatches matches_;
};

}  // namespace tandem::mbd
