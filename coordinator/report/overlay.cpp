#include "coordinator/report/overlay.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <ostream>

namespace tandem::launch {
namespace {

// It has more letters than the font inside POV-Ray, and comes with matplotlib.
constexpr const char* font_file = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

const std::string& font() {
  static const std::string chosen =
      std::filesystem::exists(font_file) ? fmt::format("ttf \"{}\"", font_file) : "internal 2";
  return chosen;
}

// As a string of POV-Ray's language.
std::string quoted(const std::string& words) {
  std::string out = "\"";
  for (const char c : words) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + '"';
}

std::string srgb(Vec3d c, double clearness) {
  return fmt::format("pigment {{ srgbt <{:.3g},{:.3g},{:.3g},{:.3g}> }}", c.x, c.y, c.z, clearness);
}

// Light does not change these colours.
constexpr const char* flat = "finish { ambient 0 diffuse 0 emission 1 } no_shadow no_reflection";

constexpr std::size_t most_entries = 12;
constexpr Vec3d panel_colour{1, 1, 1};
constexpr double panel_clearness = 0.28, margin = 14, pad = 10;

}  // namespace

Overlay::Overlay(std::ostream& out, Vec3d eye, Vec3d view, Vec3d up, double field_of_view, double aspect,
                 double height, double near)
    : out_(out),
      eye_(eye),
      right_(normalized(cross(view, up))),
      top_(cross(right_, normalized(view))),
      view_(normalized(view)),
      slope_(std::tan(0.5 * field_of_view * std::numbers::pi / 180)),
      aspect_(aspect),
      height_(height),
      near_(near) {}

std::optional<Spot> Overlay::spot(Vec3d point) const {
  const Vec3d p = point - eye_;
  const double depth = dot(p, view_);
  if (!(depth > 0)) return {};
  const double half = slope_ * depth;
  return Spot{0.5 * width() * (1 + dot(p, right_) / half),
              0.5 * height_ * (1 + dot(p, top_) / (half / aspect_))};
}

// From the frame of the camera to the scene.
std::string Overlay::placed() const {
  const auto row = [](Vec3d v) { return fmt::format("{:.9g},{:.9g},{:.9g}", v.x, v.y, v.z); };
  return fmt::format("matrix <{},{},{},{}>", row(right_), row(top_), row(view_), row(eye_));
}

Vec3d Overlay::local(Spot at, double depth) const {
  const double half = slope_ * depth;
  return {half * (2 * at.x / width() - 1), half / aspect_ * (2 * at.y / height_ - 1), depth};
}

void Overlay::text(Spot at, double size, const std::string& words, Align align, Vec3d colour) {
  if (words.empty()) return;
  const Vec3d p = local(at, near_);
  const double em = 2 * slope_ * near_ / width() * size;
  const char* shift = align == Align::left ? "0" : align == Align::right ? "-1" : "-0.5";
  fmt::print(out_,
             "#declare T = text {{ {} {} 0.02 0 }}\nobject {{ T translate {}*max_extent(T).x*x scale {:.6g} "
             "translate <{:.7g},{:.7g},{:.7g}> {} {} {} }}\n",
             font(), quoted(words), shift, em, p.x, p.y, p.z, placed(), srgb(colour, 0), flat);
}

void Overlay::box(Spot low, Spot high, Vec3d colour, double clearness, int layer) {
  const double depth = near_ * (1.02 - 1e-3 * layer);
  const Vec3d a = local(low, depth), b = local(high, depth);
  fmt::print(out_,
             "polygon {{ 4, <{0:.7g},{1:.7g}>, <{2:.7g},{1:.7g}>, <{2:.7g},{3:.7g}>, <{0:.7g},{3:.7g}> ", a.x,
             a.y, b.x, b.y);
  fmt::print(out_, "translate {:.7g}*z {} {} {} }}\n", depth, placed(), srgb(colour, clearness), flat);
}

void Overlay::line(Spot from, Spot to, Vec3d colour, double thickness) {
  const double depth = 1.03 * near_;
  const Vec3d a = local(from, depth), b = local(to, depth);
  if (norm(b - a) < 1e-9 * near_) return;
  fmt::print(out_, "cylinder {{ <{:.7g},{:.7g},{:.7g}>, <{:.7g},{:.7g},{:.7g}>, {:.6g} {} {} {} }}\n", a.x,
             a.y, a.z, b.x, b.y, b.z, slope_ * depth / width() * thickness, placed(), srgb(colour, 0), flat);
}

double Overlay::text_width(const std::string& words, double size) {
  double em = 0;
  for (const char c : words) {
    if ((static_cast<unsigned char>(c) & 0xC0) == 0x80) continue;  // inside a letter of several bytes
    const std::string_view narrow = "ijlIftr.,:;|!'()[] ", wide = "mwMW@%_";
    em += narrow.find(c) != std::string_view::npos ? 0.37
          : wide.find(c) != std::string_view::npos ? 0.93
                                                   : 0.64;
  }
  return em * size;
}

void draw_scale(Overlay& overlay, const ColourScale& scale) {
  constexpr double size = 15, length = 280, thickness = 14;
  const double right = overlay.width() - margin;
  if (!scale.names.empty()) {
    double widest = Overlay::text_width(scale.title, size);
    const std::size_t shown = std::min(scale.names.size(), most_entries);
    for (std::size_t k = 0; k < shown; ++k)
      widest = std::max(widest, Overlay::text_width(scale.names[k], size) + 24);
    const double left = right - widest - 2 * pad;
    double y = margin + pad + 22 * static_cast<double>(shown);
    overlay.box({left, margin}, {right, y + 26}, panel_colour, panel_clearness);
    overlay.text({left + pad, y + 6}, size, scale.title);
    for (std::size_t k = 0; k < shown; ++k) {
      y -= 22;
      overlay.box({left + pad, y}, {left + pad + 16, y + 14}, group_colour(k), 0, 1);
      overlay.text({left + pad + 24, y + 2}, size, scale.names[k]);
    }
    return;
  }
  const double left = right - length - 2 * (pad + 12), x = left + pad + 12, low = margin + 30;
  overlay.box({left, margin}, {right, low + thickness + 30}, panel_colour, panel_clearness);
  overlay.text({x, low + thickness + 9}, size, scale.title);
  constexpr int parts = 70;
  for (int k = 0; k < parts; ++k)
    overlay.box({x + length * k / parts, low}, {x + length * (k + 1) / parts, low + thickness},
                bar_colour((k + 0.5) / parts), 0, 1);
  for (const double tick : ticks(scale.low, scale.high)) {
    const double at = x + length * (tick - scale.low) / (scale.high - scale.low);
    overlay.box({at - 0.6, low - 5}, {at + 0.6, low}, {0.13, 0.15, 0.18}, 0, 2);
    overlay.text({at, low - 20}, 13, fmt::format("{:.6g}", tick == 0 ? 0.0 : tick), Align::middle);
  }
  if (scale.exceeded)
    overlay.text({x + length, low + thickness + 9}, 12, "and above", Align::right, {0.35, 0.38, 0.42});
}

void draw_legend(Overlay& overlay, const std::string& title, const std::vector<LegendEntry>& entries) {
  constexpr double size = 15, row = 22;
  const std::size_t shown = std::min(entries.size(), most_entries);
  const std::string more =
      entries.size() > shown ? fmt::format("and {} more bodies", entries.size() - shown) : "";
  double widest = std::max(Overlay::text_width(title, size), Overlay::text_width(more, size));
  for (std::size_t k = 0; k < shown; ++k)
    widest = std::max(widest, Overlay::text_width(entries[k].name, size) + 24);
  const double rows = static_cast<double>(shown) + (title.empty() ? 0 : 1) + (more.empty() ? 0 : 1);
  if (rows == 0) return;
  const double top = overlay.height() - margin, x = margin + pad;
  overlay.box({margin, top - rows * row - pad}, {x + widest + pad, top}, panel_colour, panel_clearness);
  double y = top - 6 - size;
  if (!title.empty()) {
    overlay.text({x, y}, size, title);
    y -= row;
  }
  for (std::size_t k = 0; k < shown; ++k, y -= row) {
    overlay.box({x, y - 2}, {x + 16, y + 12}, entries[k].colour, 0, 1);
    overlay.text({x + 24, y}, size, entries[k].name);
  }
  overlay.text({x, y}, size, more);
}

}  // namespace tandem::launch
