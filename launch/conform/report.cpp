#include "launch/conform/report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/utf8.hpp"
#include "coordinator/start/build_info.hpp"
#include "protocol/registration.hpp"

namespace tandem::conform {
namespace {

using Json = nlohmann::ordered_json;

std::string number(double value) {
  return fmt::format("{:.6g}", value);
}

std::string value_text(const std::vector<double>& values) {
  if (values.size() == 1) return number(values[0]);
  std::string text;
  for (const double value : values) text += (text.empty() ? "(" : ", ") + number(value);
  return text + ")";
}

// JSON has no NaN.
Json json_number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json json_numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(json_number(value));
  return list;
}

std::string finding_text(const Finding& finding) {
  const std::string unit = finding.unit.empty() ? "" : " " + finding.unit;
  return fmt::format("{}: {}{}, expected {}, tolerance {:.2g}", finding.what, value_text(finding.measured),
                     unit, value_text(finding.expected), finding.tolerance);
}

// Whether the sentence is what the check objects to; otherwise the worst finding is.
bool by_sentence(const Result& result) {
  if (result.sentence.empty()) return false;
  return result.findings.empty() || result.worst()->passed();
}

std::string verdict_text(const Result& result) {
  switch (result.outcome) {
    case Outcome::passed:
      return result.worst() ? finding_text(*result.worst()) : "as it must be";
    case Outcome::failed:
      return by_sentence(result) || !result.worst() ? printable(result.sentence)
                                                    : finding_text(*result.worst());
    case Outcome::refused:
      return printable(result.sentence);
    case Outcome::not_claimed:
      return "needs " + protocol::capability_names(result.check->needs);
  }
  return "";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

const char* word(Outcome outcome) {
  switch (outcome) {
    case Outcome::passed:
      return "passed";
    case Outcome::failed:
      return "failed";
    case Outcome::refused:
      return "refused";
    case Outcome::not_claimed:
      return "not_claimed";
  }
  return "";
}

constexpr const char* style = R"(
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 70em; padding: 0 1em; color: #1a1a1a; background: #fff; }
h1 { font-size: 1.4em; } h1 .badge { font-size: .8em; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: .35em .7em; border-bottom: 1px solid #ddd; }
th { border-bottom: 2px solid #888; }
td.check { font-family: ui-monospace, monospace; white-space: nowrap; }
td.seen { overflow-wrap: anywhere; }
.meaning { color: #555; }
.badge { display: inline-block; border-radius: .3em; padding: 0 .5em; color: #fff; white-space: nowrap; }
.passed { background: #1a7f37; } .failed { background: #b91c1c; } .refused { background: #9a6700; } .not_claimed { background: #6e7781; }
details table { font-size: .9em; } details tr.bad td { color: #b91c1c; font-weight: 600; }
summary { cursor: pointer; }
)";

}  // namespace

std::string row(const Result& result) {
  return fmt::format("{:<12} {:<25} {}\n", name(result.outcome), result.check->name, verdict_text(result));
}

std::string last_line(const Judgement& judgement) {
  std::string text = fmt::format("{} ({}): {} passed, {} failed, {} refused, {} not claimed\n",
                                 judgement.program.empty() ? "the participant" : printable(judgement.program),
                                 protocol::name(judgement.role), judgement.count(Outcome::passed),
                                 judgement.count(Outcome::failed), judgement.count(Outcome::refused),
                                 judgement.count(Outcome::not_claimed));
  if (!judgement.accepted() && judgement.count(Outcome::refused) > 0)
    text +=
        "it refused each scene, so that nothing of it could be judged: try --scene FILE with a scene that it "
        "takes\n";
  return text;
}

std::string table(const Judgement& judgement) {
  std::string text;
  for (const Result& result : judgement.results) text += row(result);
  return text + last_line(judgement);
}

Json to_json(const Judgement& judgement) {
  Json results = Json::array();
  for (const Result& result : judgement.results) {
    Json findings = Json::array();
    for (const Finding& finding : result.findings)
      findings.push_back({{"what", finding.what},
                          {"unit", finding.unit},
                          {"measured", json_numbers(finding.measured)},
                          {"expected", json_numbers(finding.expected)},
                          {"deviation", json_number(finding.deviation)},
                          {"tolerance", json_number(finding.tolerance)},
                          {"passed", finding.passed()}});
    results.push_back({{"check", result.check->name},
                       {"meaning", result.check->meaning},
                       {"outcome", word(result.outcome)},
                       {"scene", result.scene},
                       {"sentence", printable(result.sentence)},
                       {"seconds", result.seconds},
                       {"findings", findings}});
  }
  Json capabilities = Json::array();
  for (int bit = 0; bit < 64; ++bit)
    if (const std::uint64_t mask = std::uint64_t{1} << bit; judgement.capabilities & mask)
      capabilities.push_back(protocol::capability_names(mask));
  return {{"program", printable(judgement.program)},
          {"role", protocol::word_of(judgement.role)},
          {"version", launch::version},
          {"capabilities", capabilities},
          {"passed", judgement.passed()},
          {"counts",
           {{"passed", judgement.count(Outcome::passed)},
            {"failed", judgement.count(Outcome::failed)},
            {"refused", judgement.count(Outcome::refused)},
            {"not_claimed", judgement.count(Outcome::not_claimed)}}},
          {"checks", results}};
}

std::string page(const Judgement& judgement) {
  const bool passed = judgement.passed();
  std::string text = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>{0}: conformance</title><style>{1}</style></head><body>\n"
      "<h1>{0} <span class=\"badge {2}\">{3}</span></h1>\n<p>Judged as {4} by tandem {5}. Capabilities: "
      "{6}.<br>{7} passed, "
      "{8} failed, {9} refused, {10} not claimed.</p>\n"
      "<table><thead><tr><th>check</th><th>outcome</th><th>what it means, and what was "
      "seen</th></tr></thead><tbody>\n",
      escaped(printable(judgement.program)), style, passed ? "passed" : "failed",
      passed ? "conforms" : "does not conform", protocol::name(judgement.role), launch::version,
      escaped(protocol::capability_names(judgement.capabilities)), judgement.count(Outcome::passed),
      judgement.count(Outcome::failed), judgement.count(Outcome::refused),
      judgement.count(Outcome::not_claimed));
  for (const Result& result : judgement.results) {
    text += fmt::format(
        "<tr><td class=\"check\">{}</td><td><span class=\"badge {}\">{}</span></td><td class=\"seen\"><span "
        "class=\"meaning\">{}</span><br>{}",
        result.check->name, word(result.outcome), name(result.outcome), escaped(result.check->meaning),
        escaped(verdict_text(result)));
    if (!result.findings.empty()) {
      text += fmt::format(
          "<details{}><summary>{} figures on scene "
          "{}</summary><table><tr><th>figure</th><th>measured</th><th>expected</th>"
          "<th>deviation</th><th>tolerance</th></tr>",
          result.outcome == Outcome::failed ? " open" : "", result.findings.size(), escaped(result.scene));
      for (const Finding& f : result.findings)
        text += fmt::format("<tr{}><td>{}</td><td>{} {}</td><td>{}</td><td>{:.3g}</td><td>{:.3g}</td></tr>",
                            f.passed() ? "" : " class=\"bad\"", escaped(f.what), value_text(f.measured),
                            escaped(f.unit), value_text(f.expected), f.deviation, f.tolerance);
      text += "</table></details>";
    }
    text += "</td></tr>\n";
  }
  return text + "</tbody></table></body></html>\n";
}

}  // namespace tandem::conform
