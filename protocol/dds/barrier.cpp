#include "protocol/dds/barrier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "common/error.hpp"
#include "protocol/dds/cyclone_log.hpp"

namespace tandem::protocol::dds {

namespace {

using namespace std::chrono_literals;
using Presence = tandem_dds_Presence;

constexpr EndId no_end{};
// Time in which an end has to join the coordinator that has chosen it; then another end is tried.
constexpr auto answer_time = 2s;

class Barrier {
 public:
  Barrier(Station& station, const DdsOptions& options, Side side, const Network& network)
      : station_(station), options_(options), side_(side), network_(network) {}

  Partner pass(Deadline deadline) {
    const auto begin = Clock::now();
    station_.announce(nullptr, 0);
    for (;;) {
      const std::uint64_t seen = station_.events().count();
      check_compatible();
      station_.strangers().log_new(options_.run);
      if (const auto partner = find_partner()) return *partner;
      if (options_.idle) options_.idle();
      const auto now = Clock::now();
      if (now >= deadline) throw missing(std::chrono::duration<double>(now - begin).count());
      station_.events().sleep(seen, std::min(deadline, now + 50ms));
    }
  }

 private:
  std::string name_of(const Presence& end) const { return dds::name_of(end, options_.role); }
  std::string run() const { return fmt::format("run '{}'", options_.run); }
  std::string where() const {
    return fmt::format("dds on interface {} ({})", network_.interface, network_.address);
  }

  std::optional<Partner> find_partner() {
    heard_ = station_.present();
    check_proofs();
    const Presence* chosen = choose();
    if (chosen == nullptr) {
      check_taken();
      return {};
    }
    taken_since_ = {};
    const EndId id = end_id(chosen->end);
    const dds_instance_handle_t writer = station_.writer_of(id), reader = station_.reader_of(id);
    if (writer == 0 || reader == 0) return {};
    if (side_ == Side::coordinator && choice_ != id) {
      choice_ = id;
      chosen_at_ = tried_[id] = Clock::now();
      station_.accept_from(writer);  // it may send as soon as it knows that it is chosen
      station_.announce(chosen, 0);
    }
    if (!joins_us(*chosen)) return {};

    station_.accept_from(writer);
    station_.events().watch(writer, reader);
    const Partner partner{*chosen, name_of(*chosen)};
    heard_ = station_.present();
    if (find(id) == nullptr || station_.writer_of(id) != writer || station_.reader_of(id) != reader)
      return {};
    if (side_ == Side::participant) station_.announce(&partner.presence, 0);
    return partner;
  }

  // It has sent our nonce, so it is not a recording.
  bool joins_us(const Presence& end) const {
    return end_id(end.partner) == station_.id() && std::to_array(end.partner_nonce) == station_.nonce();
  }

  // An end without a secret would wait forever for one that requires it.
  void check_proofs() const {
    if (station_.requires_proof()) return;
    for (const Presence& end : heard_)
      if (opposite(end) && end.asks != tandem_dds_no_proof)
        throw Error(ErrorCode::protocol,
                    fmt::format("{} of {} requires the run's secret, and this end was given none",
                                name_of(end), run()),
                    where(), "give --secret-file FILE, or set TANDEM_SECRET");
  }

  // The coordinator chooses a free participant and keeps it; the participant joins the coordinator that has
  // chosen it.
  const Presence* choose() {
    if (choice_ != no_end) {
      const Presence* kept = find(choice_);
      if (kept != nullptr && (joins_us(*kept) || Clock::now() - chosen_at_ < answer_time)) return kept;
      if (kept != nullptr) station_.strangers().report(name_of(*kept), "it was chosen and did not answer");
      choice_ = no_end;
    }
    const Presence* chosen = nullptr;
    for (const Presence& end : heard_) {
      if (!opposite(end)) continue;
      if (joins_us(end)) return &end;
      if (side_ != Side::coordinator || end_id(end.partner) != no_end) continue;
      // Of the free ends, the one that has not been tried for the longest time.
      if (chosen == nullptr || tried_[end_id(end.end)] < tried_[end_id(chosen->end)]) chosen = &end;
    }
    return chosen;
  }

  const Presence* find(const EndId& id) const {
    const auto found =
        std::ranges::find_if(heard_, [&](const Presence& end) { return end_id(end.end) == id; });
    return found == heard_.end() ? nullptr : &*found;
  }
  bool opposite(const Presence& end) const {
    return (end.side == tandem_dds_coordinator_side) == (side_ == Side::participant);
  }

  // The other end belongs to another pair. Ends of an earlier run of this name that were killed still count
  // as present for one lease, so that this has to last longer before it is an error.
  void check_taken() {
    for (const Presence& end : heard_) {
      const Presence* rival = opposite(end) ? find(end_id(end.partner)) : nullptr;
      if (rival == nullptr) continue;
      const auto now = Clock::now();
      if (!taken_since_) taken_since_ = now;
      if (now - *taken_since_ < 2 * options_.lease + 200ms) return;
      throw Error(ErrorCode::protocol,
                  fmt::format("{} of {} already belongs to {}", name_of(end), run(), name_of(*rival)),
                  where(), "give each run a name of its own");
    }
    taken_since_ = {};
  }

  // With a secret, an unknown end with other types must not end the wait.
  void check_compatible() {
    const std::uint32_t policy = station_.events().incompatible();
    if (policy == 0) return;
    if (station_.requires_proof()) {
      if (!logged_incompatible_)
        station_.strangers().report(
            "an end of unknown name",
            "it has other DDS types or another quality of service, as other versions have");
      logged_incompatible_ = true;
      return;
    }
    throw Error(ErrorCode::protocol,
                policy == DDS_TYPE_CONSISTENCY_ENFORCEMENT_QOS_POLICY_ID
                    ? fmt::format("another end of {} uses other DDS types", run())
                    : fmt::format("another end of {} requests another quality of service (DDS policy {})",
                                  run(), policy),
                where(), "run the same version of tandem on both hosts");
  }

  Error missing(double seconds) const {
    const std::string other = side_ == Side::coordinator ? name(options_.role) : "coordinator";
    const auto end = std::ranges::find_if(heard_, [this](const Presence& e) { return opposite(e); });
    std::string what;
    if (end == heard_.end()) {
      what = fmt::format("no {} joined {} within {:.1f} s", other, run(), seconds);
    } else {
      const EndId id = end_id(end->end);
      const bool hears = station_.writer_of(id) != 0, heard = station_.reader_of(id) != 0;
      what = fmt::format("{} of {} was heard but did not join within {:.1f} s: {}", name_of(*end), run(),
                         seconds,
                         !hears   ? "its sending side did not match"
                         : !heard ? "its receiving side did not match"
                                  : "it has not answered");
    }
    if (const std::string refused = station_.strangers().last(); !refused.empty())
      what += "; refused was " + refused;
    // DDS Security keeps back whom it refuses: this end sees nothing of it.
    if (const std::string refused = refused_certificate(); !options_.certificates.empty() && !refused.empty())
      return Error(ErrorCode::timeout, what + "; DDS Security refused an end: " + refused, where(),
                   "give all programs of the run copies of one folder that tandem keys --certificates made");
    if (!options_.certificates.empty())
      what +=
          "; certificates are on, and an end without them, with those of another folder or with ones that "
          "have run out is not seen";
    return Error(
        ErrorCode::timeout, what, where(),
        fmt::format("looked at {}; are run, interface, peer and firewall right on both hosts? UDP ports "
                    "{} to {} must be open",
                    fmt::join(network_.peers, ", "), first_port, last_port));
  }

  Station& station_;
  const DdsOptions& options_;
  Side side_;
  const Network& network_;
  std::vector<Presence> heard_;
  // The coordinator's choice.
  EndId choice_{};
  Clock::time_point chosen_at_{};
  std::map<EndId, Clock::time_point> tried_;
  bool logged_incompatible_ = false;
  std::optional<Clock::time_point> taken_since_;
};

}  // namespace

Partner join(Station& station, const DdsOptions& options, Side side, const Network& network,
             Deadline deadline) {
  return Barrier(station, options, side, network).pass(deadline);
}

}  // namespace tandem::protocol::dds
