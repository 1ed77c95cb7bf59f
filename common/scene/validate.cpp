#include <algorithm>

#include "common/command_line.hpp"
#include "common/scene/columns.hpp"
#include "common/scene/element_columns.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/summary_keys.hpp"
#include "common/scene/tolerance.hpp"
#include "common/scene/validate_parts.hpp"
#include "common/time.hpp"
#include "common/utf8.hpp"

namespace tandem::scene {

namespace {

void require_nanoseconds(double window, const std::string& origin, const std::string& path) {
  if (!is_whole(window * 1e9) || to_nanoseconds(window).count < 1)
    fail(origin, path, "the window of " + text(window) + " s is not a whole number of nanoseconds",
         "give a multiple of 1e-9 s");
}

void validate_times(const Scene& scene, const std::string& origin) {
  const double window = scene.coupling.window;
  require_nanoseconds(window, origin, "coupling.window");
  // Adaptive windows are cut to end at the end of the run and at the frames.
  if (const auto& adaptive = scene.coupling.adaptive) {
    const double interval = scene.output.frame_interval;
    if (interval > 0 && to_nanoseconds(interval) < to_nanoseconds(adaptive->min_window))
      fail(origin, "output.frame_interval",
           text(interval) + " s is less than coupling.adaptive.min_window of " + text(adaptive->min_window) +
               " s: each frame ends a window",
           "give at least min_window, or 0 for the first and last frame only");
    return;
  }

  const auto require_windows = [&](double time, const std::string& path) {
    const std::int64_t length = to_nanoseconds(window).count, count = to_nanoseconds(time).count;
    if (is_whole(time * 1e9) && count % length == 0 && (count > 0 || time == 0)) return;
    const double whole = static_cast<double>(std::max<std::int64_t>(1, (count + length / 2) / length));
    fail(origin, path, text(time) + " s is not a whole multiple of the window of " + text(window) + " s",
         "the nearest is " + text(to_seconds(Nanoseconds{static_cast<std::int64_t>(whole) * length})) + " s");
  };
  require_windows(scene.end_time, "end_time");
  require_windows(scene.output.frame_interval, "output.frame_interval");
}

void validate_coupling(const Scene& scene, const std::string& origin) {
  const Coupling& c = scene.coupling;
  const bool held = c.scheme == Scheme::parallel || c.scheme == Scheme::mbd_first;
  const bool second_order = c.scheme == Scheme::dem_first || c.scheme == Scheme::implicit;
  if (c.load == LoadShape::linear && held)
    fail(origin, "coupling.load", "a load that is held until the next window has no slope there",
         "use \"mean\", or scheme dem_first");
  if (c.load == LoadShape::linear && !second_order)
    fail(origin, "coupling.load", "scheme linear_implicit knows the mean of the load only", "use \"mean\"");
  if (c.load == LoadShape::end && !held && c.scheme != Scheme::dem_first)
    fail(origin, "coupling.load",
         "the end value does not conserve the impulse, which this scheme is made for", "use \"mean\"");
  if (c.path == PathShape::quadratic && !second_order)
    fail(origin, "coupling.path", "only the schemes dem_first and implicit follow a quadratic path",
         "leave it out, or use scheme dem_first");
  if (c.scheme == Scheme::dem_first && c.load == LoadShape::linear && c.path == PathShape::linear)
    fail(origin, "coupling.path",
         "a linear load along a straight path is not stable on a contact without damping",
         "add \"path\": \"quadratic\"");
  if (c.scheme == Scheme::implicit && c.load == LoadShape::mean && c.path == PathShape::quadratic)
    fail(origin, "coupling.path", "the mean of a load belongs to a path of constant velocity",
         "leave it out, or add \"load\": \"linear\"");
  if (c.iteration && c.scheme != Scheme::implicit)
    fail(origin, "coupling.iteration", "the scheme does not iterate", "leave it out, or use scheme implicit");
  if (!c.adaptive) return;
  const Adaptive& a = *c.adaptive;
  const std::string path = "coupling.adaptive";
  if (!scene.mbd || !scene.has_particles())
    fail(origin, path, "one solver alone has no error of coupling", "leave it out");
  require_nanoseconds(a.min_window, origin, path + ".min_window");
  require_nanoseconds(a.max_window, origin, path + ".max_window");
  if (c.window < a.min_window || c.window > a.max_window)
    fail(origin, "coupling.window",
         "the first window of " + text(c.window) + " s is not within " + text(a.min_window) + " s and " +
             text(a.max_window) + " s",
         "give one within coupling.adaptive");
  if (held)
    fail(origin, path,
         "a load that is held keeps either its force or its impulse when windows change their length",
         "leave it out, or use scheme dem_first");
}

// The command of a server; what it starts is looked for when a run wants to start it.
void validate_server(const std::string& command, const std::string& origin, const std::string& path) {
  if (command.empty()) return;
  try {
    split_command(command, path);
  } catch (const Error& error) {
    fail(origin, path, error.problem(), error.hint());
  }
}

void validate_camera(const Camera& camera, const std::string& origin) {
  const Vec3d view = camera.target - camera.eye;
  if (norm(view) == 0)
    fail(origin, "output.camera.target", "the target " + text(camera.target) + " is the eye itself",
         "look at another point");
  if (norm(cross(view, camera.up)) <= 1e-9 * norm(view) * norm(camera.up))
    fail(origin, "output.camera.up",
         "up " + text(camera.up) + " is parallel to the line of sight " + text(view),
         "give a direction across it");
}

// "crate" of "crate.position.x"
std::string owner(const std::string& signal) {
  return signal.substr(0, signal.find('.'));
}

void validate_column(const std::string& signal, const Scene& scene, const std::string& origin,
                     const std::string& path) {
  const std::vector<std::string> columns = all_columns(scene);
  if (std::find(columns.begin(), columns.end(), signal) != columns.end()) return;

  std::vector<std::string> owners;
  for (const std::string& column : columns)
    if (std::find(owners.begin(), owners.end(), owner(column)) == owners.end())
      owners.push_back(owner(column));
  const auto columns_of = [&](const std::string& name) {
    std::vector<std::string> own;
    std::copy_if(columns.begin(), columns.end(), std::back_inserter(own),
                 [&](const std::string& column) { return owner(column) == name; });
    return own;
  };
  const std::vector<std::string> own_columns = columns_of(owner(signal));
  std::string hint = own_columns.empty()
                         ? suggest_name(owner(signal), owners, "bodies, joints, elements and sensors")
                         : suggest_name(signal, own_columns, "signals");
  // Of a misspelt owner, its column where there is one.
  if (const std::string* meant = own_columns.empty() ? nearest_name(owner(signal), owners) : nullptr) {
    const std::string corrected = *meant + signal.substr(owner(signal).size());
    if (nearest_name(corrected, columns_of(*meant)))
      hint = suggest_name(corrected, columns_of(*meant), "signals");
  }
  fail(origin, path, "unknown signal '" + shortened(signal) + "'", hint);
}

// Whether the text is the pattern with some characters in place of each *.
bool matches(std::string_view pattern, std::string_view text) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return pattern == text;
  if (!text.starts_with(pattern.substr(0, star))) return false;
  text.remove_prefix(star);
  pattern.remove_prefix(star + 1);
  for (;; text.remove_prefix(1)) {
    if (matches(pattern, text)) return true;
    if (text.empty()) return false;
  }
}

// The columns of one chart of the report.
void validate_plot(const std::string& pattern, const Scene& scene, const std::string& origin,
                   const std::string& path) {
  if (pattern.find('*') == std::string::npos) return validate_column(pattern, scene, origin, path);
  if (std::ranges::count(pattern, '*') > 4)
    fail(origin, path, "'" + shortened(pattern) + "' has more than four *",
         "write one pattern for each chart");
  const std::vector<std::string> columns = all_columns(scene);
  if (std::ranges::any_of(columns, [&](const std::string& column) { return matches(pattern, column); }))
    return;
  std::string some;
  for (std::size_t i = 0; i < std::min<std::size_t>(columns.size(), 400); ++i) {
    const std::string& column = columns[columns.size() - 1 - i];  // those of elements are last
    if (some.size() + column.size() > 200) break;
    some += (some.empty() ? "" : ", ") + column;
  }
  fail(origin, path, "no signal matches '" + shortened(pattern) + "'",
       columns.empty() ? "leave it out: the scene has no signals" : "there are, among others: " + some);
}

// The signal of a check must be a column of the results or a number of the summary.
void validate_signal(const std::string& signal, const Scene& scene, const std::string& origin,
                     const std::string& path) {
  if (owner(signal) != "summary") return validate_column(signal, scene, origin, path);
  if (signal.size() <= std::string("summary.").size())
    fail(origin, path, "the value is \"" + signal + "\", without a key", "name a number of summary.json");
  const std::string key = signal.substr(std::string("summary.").size());
  const std::vector<std::string> known = summary_keys(scene);
  if (std::find(known.begin(), known.end(), key) != known.end()) return;
  // Only a foreign solver knows which numbers it reports.
  const auto is_foreign = [](const auto& part) { return part && !part->server.empty(); };
  if (is_foreign(scene.mbd) || is_foreign(scene.dem) || is_foreign(scene.sph)) return;
  const std::string others = runs_with(key);
  fail(origin, path, "summary.json of this scene has no number '" + shortened(key) + "'",
       others.empty() ? suggest_name(key, known, "numbers") : "that is a number of " + others);
}

void validate_check(const Check& check, const Scene& scene, const std::string& origin,
                    const std::string& path) {
  validate_signal(check.of, scene, origin, path + ".of");
  if (!check.expected_of.empty()) validate_signal(check.expected_of, scene, origin, path + ".expected.of");
  if (check.to > scene.end_time)
    fail(origin, path + ".to",
         text(check.to) + " s is after the end of the run at " + text(scene.end_time) + " s",
         "leave it out to mean the end");
  const double end = check.to == 0 ? scene.end_time : check.to;
  if (!(check.from < end))
    fail(origin, path + ".from",
         text(check.from) + " s is not before the end of the part at " + text(end) + " s",
         "give a shorter time");
  if (!check.absolute && check.expected_of.empty() && check.expected == 0)
    fail(origin, path + ".tolerance", "the tolerance is relative to an expected value of 0",
         "add \"absolute\": true");
}

}  // namespace

void require_unit(double length, const std::string& value, const std::string& unit_value,
                  const std::string& origin, const std::string& path) {
  if (is_unit(length)) return;
  fail(origin, path, value + " has length " + text(length) + ", not 1",
       length > 0 ? "the unit one is " + unit_value : "give a direction");
}

void require_unit(Vec3d direction, const std::string& origin, const std::string& path) {
  require_unit(norm(direction), text(direction), text(normalized(direction)), origin, path);
}

void require_unit(Quat q, const std::string& origin, const std::string& path) {
  const auto written = [](Quat p) {
    return "[" + text(p.w) + ", " + text(p.x) + ", " + text(p.y) + ", " + text(p.z) + "]";
  };
  require_unit(std::sqrt(q.norm2()), written(q), written(q.normalized()), origin, path);
}

void require_box(Vec3d min, Vec3d max, const std::string& origin, const std::string& path) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(min[axis] < max[axis]))
      fail(origin, element(path + ".max", axis),
           text(max[axis]) + " m is not above the minimum of " + text(min[axis]) + " m",
           "min < max along each axis");
}

void validate(const Scene& scene, const std::string& origin) {
  if (!scene.mbd && !scene.has_particles())
    fail(origin, "", "the scene has neither 'mbd' nor 'dem' nor 'sph'",
         "give bodies, particles, a liquid, or several of them");
  validate_times(scene, origin);
  validate_coupling(scene, origin);
  if (scene.mbd) validate_server(scene.mbd->server, origin, "mbd.server");
  if (scene.dem) validate_server(scene.dem->server, origin, "dem.server");
  if (scene.mbd) validate_mbd(*scene.mbd, scene.coupling.window, scene.end_time, origin);
  if (scene.dem) validate_dem(*scene.dem, scene.coupling.window, origin);
  if (scene.dem) validate_walls(scene, origin);
  if (scene.sph) {
    validate_server(scene.sph->server, origin, "sph.server");
    validate_sph(scene, origin);
    validate_liquid_walls(scene, origin);
  }
  validate_fills(scene, origin);
  validate_shapes(scene, origin);
  if (scene.dem && scene.dem->follows) validate_moving_domain(scene, origin);
  if (scene.dem) validate_particle_sensors(scene, origin);
  if (scene.sph) validate_liquid_sensors(scene, origin);
  if (scene.mbd)
    for (std::size_t i = 0; i < scene.mbd->sensors.size(); ++i)
      validate_column(scene.mbd->sensors[i], scene, origin, element("mbd.sensors", i));
  validate_dissipation(scene, origin);
  validate_wall_fields(scene, origin);
  validate_body_contacts(scene, origin);
  if (scene.output.camera) validate_camera(*scene.output.camera, origin);
  if (!scene.output.fields.empty() && (!scene.dem || !scene.output.particles))
    fail(origin, "output.fields", "are columns of the spheres in frames, and frames of this scene have none",
         scene.dem ? "leave out output.fields, or write \"particles\": true" : "leave out output.fields");
  for (std::size_t i = 0; i < scene.output.plots.size(); ++i)
    validate_plot(scene.output.plots[i], scene, origin, element("output.plots", i));
  for (std::size_t i = 0; i < scene.checks.size(); ++i)
    validate_check(scene.checks[i], scene, origin, element("checks", i));
}

}  // namespace tandem::scene
