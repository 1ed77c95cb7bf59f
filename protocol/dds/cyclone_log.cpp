#include "protocol/dds/cyclone_log.hpp"

#include <dds/dds.h>
#include <dds/ddsrt/log.h>
#include <fmt/format.h>

#include <mutex>
#include <utility>

#include "common/log.hpp"
#include "common/utf8.hpp"

namespace tandem::protocol::dds {
namespace {

constexpr std::size_t longest_line = 300;  // they repeat bytes of packets

struct Lines {
  std::mutex mutex;
  LineLimit limit;
  std::string refused;
};
Lines& lines() {
  static Lines lines;
  return lines;
}

// Called by the threads of Cyclone DDS.
void take(void*, const dds_log_data_t* data) {
  std::string text(data->message);  // behind the header, which has a time of its own
  while (!text.empty() && text.back() == '\n') text.pop_back();
  text = printable(shortened(text, longest_line));
  std::string rest;
  {
    Lines& l = lines();
    const std::lock_guard lock(l.mutex);
    // "fsm: Begin handshake reply failed: Certificate not valid: error: unable to get local issuer ..."
    if (const std::size_t at = text.find("Certificate not valid"); at != std::string::npos)
      l.refused = text.substr(at);
    const LineLimit::Fate fate = l.limit.judge(std::chrono::steady_clock::now());
    if (fate == LineLimit::Fate::left_out) return;
    if (const std::uint64_t left_out = l.limit.take_left_out(); left_out > 0)
      rest = fmt::format(" ({} lines before this one were left out)", left_out);
    if (fate == LineLimit::Fate::last_of_span)
      rest += fmt::format(" ({} lines within {} s: further ones are left out)", LineLimit::most,
                          LineLimit::span.count());
  }
  // Not by its raw pointer, which another thread may be replacing.
  spdlog::default_logger()->log(
      (data->priority & (DDS_LC_ERROR | DDS_LC_FATAL)) != 0 ? spdlog::level::err : spdlog::level::warn,
      "Cyclone DDS: {}{}", text, rest);
}

}  // namespace

LineLimit::Fate LineLimit::judge(Time now) {
  if (now - begin_ >= span) begin_ = now, written_ = 0;
  if (written_ == most) {
    ++left_out_;
    return Fate::left_out;
  }
  return ++written_ == most ? Fate::last_of_span : Fate::written;
}

std::uint64_t LineLimit::take_left_out() {
  return std::exchange(left_out_, 0);
}

void take_cyclone_lines() {
  static std::once_flag once;
  std::call_once(once, [] { dds_set_log_sink(take, nullptr); });
}

std::string refused_certificate() {
  const std::lock_guard lock(lines().mutex);
  return lines().refused;
}

}  // namespace tandem::protocol::dds
