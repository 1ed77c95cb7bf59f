// The participant kit for C++17 and later: derive from MotionSolver, LoadSolver or LiquidSolver, and call
// run() in main(). tandem/participant.h says what every struct and every call means; this header adds
// classes, ranges and exceptions, and copies nothing.
#ifndef TANDEM_PARTICIPANT_HPP
#define TANDEM_PARTICIPANT_HPP

#include <tandem/participant.h>

#include <exception>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace tandem::participant {

enum class Code {
  internal = TANDEM_ERROR_INTERNAL,  // a defect of the solver
  scene = TANDEM_ERROR_SCENE,        // the scene is wrong, or asks for what this solver does not know
  numerics = TANDEM_ERROR_NUMERICS,  // the solver cannot continue
  resource = TANDEM_ERROR_RESOURCE,  // memory, device, disk
};

// Ends the run on all sides with this sentence. A solver may throw it, and any other exception, from every
// function: std::bad_alloc counts as `resource`, others as `internal`.
class Error : public std::exception {
 public:
  // what: "mass is -1 kg"; where: "mbd.bodies 'bob'"; hint: "give a mass > 0". Where and hint may be empty.
  explicit Error(Code code, std::string what, std::string where = {}, std::string hint = {})
      : code_(code), what_(std::move(what)), where_(std::move(where)), hint_(std::move(hint)) {}

  Code code() const noexcept { return code_; }
  const char* what() const noexcept override { return what_.c_str(); }
  const std::string& where() const noexcept { return where_; }
  const std::string& hint() const noexcept { return hint_; }

 private:
  Code code_;
  std::string what_, where_, hint_;
};

// Elements that belong to somebody else.
template <class T>
class Range {
 public:
  Range(T* data, std::size_t size) : data_(data), size_(size) {}
  T* begin() const { return data_; }
  T* end() const { return data_ + size_; }
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) const { return data_[i]; }

 private:
  T* data_;
  std::size_t size_;
};

// clang-format off
inline Range<tandem_body_motion> bodies(const tandem_motion_set& set) { return {set.bodies, set.count}; }
inline Range<tandem_body_load> loads(const tandem_load_set& set) { return {set.bodies, set.count}; }
inline Range<tandem_body_tangent> tangents(const tandem_tangent_set& set) { return {set.bodies, set.count}; }
inline Range<tandem_body_state> bodies(const tandem_bodies_frame& frame) { return {frame.bodies, frame.body_count}; }
inline Range<tandem_joint_state> joints(const tandem_bodies_frame& frame) { return {frame.joints, frame.joint_count}; }
inline Range<double> elements(const tandem_bodies_frame& frame) { return {frame.elements, frame.element_count}; }
inline Range<const double> values(const tandem_control_set& set) { return {set.values, set.count}; }
inline Range<const tandem_body> bodies(const tandem_configuration& c) { return {c.bodies, c.body_count}; }
inline Range<const std::uint32_t> boundary(const tandem_configuration& c) { return {c.boundary, c.boundary_count}; }
inline Range<const tandem_material> materials(const tandem_configuration& c) { return {c.materials, c.material_count}; }
inline Range<const tandem_pair> pairs(const tandem_configuration& c) { return {c.pairs, c.pair_count}; }
inline Range<const tandem_liquid> liquids(const tandem_configuration& c) { return {c.liquids, c.liquid_count}; }
inline Range<const tandem_wall> walls(const tandem_configuration& c) { return {c.walls, c.wall_count}; }
inline Range<const char* const> element_columns(const tandem_configuration& c) { return {c.element_columns, c.element_count}; }
// clang-format on

// Length of a window [s].
inline double length(const tandem_window& window) {
  return static_cast<double>(window.end - window.begin) / 1e9;
}

// Figures and warnings for the summary of the run.
class Facts {
 public:
  explicit Facts(tandem_facts* facts) : facts_(facts) {}
  void number(const std::string& key, double value) { tandem_fact_number(facts_, key.c_str(), value); }
  void text(const std::string& key, const std::string& value) {
    tandem_fact_text(facts_, key.c_str(), value.c_str());
  }
  void warn(const std::string& sentence) { tandem_warn(facts_, sentence.c_str()); }

 private:
  tandem_facts* facts_;
};

inline void log(const std::string& sentence) {
  tandem_log('i', sentence.c_str());
}

namespace detail {

// A function of the library has failed and left its reason there.
struct Failed {
  int status;
};

template <class Call>
int guarded(const char* function, Call call) noexcept {
  try {
    call();
    return TANDEM_OK;
  } catch (const Failed& failed) {
    return failed.status;
  } catch (const Error& error) {
    return tandem_fail(static_cast<int>(error.code()), error.what(),
                       error.where().empty() ? function : error.where().c_str(), error.hint().c_str());
  } catch (const std::bad_alloc&) {
    return tandem_fail(TANDEM_ERROR_RESOURCE, "no memory is left", function,
                       "make the scene smaller, or take a machine with more memory");
  } catch (const std::exception& error) {
    return tandem_fail(TANDEM_ERROR_INTERNAL, error.what(), function, "report it to the solver's author");
  } catch (...) {
    return tandem_fail(TANDEM_ERROR_INTERNAL, "threw what is no std::exception", function,
                       "throw tandem::participant::Error");
  }
}

[[noreturn]] inline void missing(const char* function) {
  throw Error(Code::internal,
              "is called, because capabilities() promises it, but the solver does not override it", function,
              "override it, or state less");
}

}  // namespace detail

struct State {
  tandem_pose pose;
  tandem_twist twist;
};

// Of a body `seconds` after the begin of the window (tandem_pose_at).
inline State pose_at(const tandem_body_motion& motion, const tandem_window& window, double seconds) {
  State state;
  const int status = tandem_pose_at(&motion, &window, seconds, &state.pose, &state.twist);
  if (status != TANDEM_OK) throw detail::Failed{status};
  return state;
}

// What both kinds of solvers have. The functions from save() on are called only where capabilities() promises
// them.
class Solver {
 public:
  Solver() = default;
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;
  virtual ~Solver() = default;

  // TANDEM_CAN_... ; 0 for none. Read once, before configure().
  virtual std::uint64_t capabilities() const = 0;
  // Names of the features of scenes that this solver knows (docs/participant.md). Read once.
  virtual std::vector<std::string> features() const = 0;
  virtual void report(Facts&) {}

  virtual void save() { detail::missing("save"); }
  virtual void restore() { detail::missing("restore"); }
  virtual void checkpoint(const tandem_state_file&) { detail::missing("checkpoint"); }
  virtual void resume(const tandem_state_file&) { detail::missing("resume"); }
};

class MotionSolver : public Solver {
 public:
  virtual void configure(const tandem_configuration&, tandem_motion_set& initial, Facts&) = 0;
  virtual void advance(const tandem_load_set&, tandem_motion_set&) = 0;
  virtual void observe(tandem_bodies_frame&) = 0;

  virtual void predict(const tandem_window&, tandem_motion_set&) { detail::missing("predict"); }
  virtual void extrapolate(const tandem_window&, tandem_motion_set&) { detail::missing("extrapolate"); }
  virtual void control(const tandem_control_set&) { detail::missing("control"); }
};

// Of spheres; a LiquidSolver has the same functions.
class LoadSolver : public Solver {
 public:
  virtual void configure(const tandem_configuration&, Facts&) = 0;
  virtual void advance(const tandem_motion_set&, tandem_load_set&) = 0;
  virtual void observe(tandem_particles_frame&) = 0;

  virtual void linearise(tandem_tangent_set&) { detail::missing("linearise"); }
};

class LiquidSolver : public LoadSolver {};

namespace detail {

class FeatureList {
 public:
  explicit FeatureList(std::vector<std::string> names) : names_(std::move(names)) {
    for (const std::string& name : names_) list_.push_back(name.c_str());
    list_.push_back(nullptr);
  }
  FeatureList(const FeatureList&) = delete;
  FeatureList& operator=(const FeatureList&) = delete;
  const char* const* list() const { return list_.data(); }

 private:
  std::vector<std::string> names_;
  std::vector<const char*> list_;
};

template <class Table, class Base>
void fill_common(Table& table) {
  table.report = [](void* self, tandem_facts* facts) {
    Facts given(facts);
    return guarded("report", [&] { static_cast<Base*>(self)->report(given); });
  };
  table.save = [](void* self) { return guarded("save", [&] { static_cast<Base*>(self)->save(); }); };
  table.restore = [](void* self) { return guarded("restore", [&] { static_cast<Base*>(self)->restore(); }); };
  table.checkpoint = [](void* self, const tandem_state_file* file) {
    return guarded("checkpoint", [&] { static_cast<Base*>(self)->checkpoint(*file); });
  };
  table.resume = [](void* self, const tandem_state_file* file) {
    return guarded("resume", [&] { static_cast<Base*>(self)->resume(*file); });
  };
}

}  // namespace detail

// The main function of a participant; `program` is name and version, "my_solver 1.2". Returns the exit
// status.
inline int run(int argc, char** argv, const char* program, MotionSolver& solver) {
  const detail::FeatureList features(solver.features());
  tandem_motion_solver table{};
  table.size = sizeof table;
  table.capabilities = solver.capabilities();
  table.features = features.list();
  detail::fill_common<tandem_motion_solver, MotionSolver>(table);
  table.configure = [](void* self, const tandem_configuration* configuration, tandem_motion_set* initial,
                       tandem_facts* facts) {
    Facts given(facts);
    return detail::guarded(
        "configure", [&] { static_cast<MotionSolver*>(self)->configure(*configuration, *initial, given); });
  };
  table.advance = [](void* self, const tandem_load_set* loads, tandem_motion_set* motion) {
    return detail::guarded("advance", [&] { static_cast<MotionSolver*>(self)->advance(*loads, *motion); });
  };
  table.observe = [](void* self, tandem_bodies_frame* frame) {
    return detail::guarded("observe", [&] { static_cast<MotionSolver*>(self)->observe(*frame); });
  };
  table.predict = [](void* self, const tandem_window* window, tandem_motion_set* motion) {
    return detail::guarded("predict", [&] { static_cast<MotionSolver*>(self)->predict(*window, *motion); });
  };
  table.extrapolate = [](void* self, const tandem_window* window, tandem_motion_set* motion) {
    return detail::guarded("extrapolate",
                           [&] { static_cast<MotionSolver*>(self)->extrapolate(*window, *motion); });
  };
  table.control = [](void* self, const tandem_control_set* inputs) {
    return detail::guarded("control", [&] { static_cast<MotionSolver*>(self)->control(*inputs); });
  };
  return tandem_motion_main(argc, argv, program, &table, &solver);
}

namespace detail {

// `main`: tandem_load_main or tandem_liquid_main.
inline int run_load(decltype(tandem_load_main)& main, int argc, char** argv, const char* program,
                    LoadSolver& solver) {
  const detail::FeatureList features(solver.features());
  tandem_load_solver table{};
  table.size = sizeof table;
  table.capabilities = solver.capabilities();
  table.features = features.list();
  detail::fill_common<tandem_load_solver, LoadSolver>(table);
  table.configure = [](void* self, const tandem_configuration* configuration, tandem_facts* facts) {
    Facts given(facts);
    return detail::guarded("configure",
                           [&] { static_cast<LoadSolver*>(self)->configure(*configuration, given); });
  };
  table.advance = [](void* self, const tandem_motion_set* motion, tandem_load_set* loads) {
    return detail::guarded("advance", [&] { static_cast<LoadSolver*>(self)->advance(*motion, *loads); });
  };
  table.observe = [](void* self, tandem_particles_frame* frame) {
    return detail::guarded("observe", [&] { static_cast<LoadSolver*>(self)->observe(*frame); });
  };
  table.linearise = [](void* self, tandem_tangent_set* tangents) {
    return detail::guarded("linearise", [&] { static_cast<LoadSolver*>(self)->linearise(*tangents); });
  };
  return main(argc, argv, program, &table, &solver);
}

}  // namespace detail

inline int run(int argc, char** argv, const char* program, LoadSolver& solver) {
  return detail::run_load(tandem_load_main, argc, argv, program, solver);
}
inline int run(int argc, char** argv, const char* program, LiquidSolver& solver) {
  return detail::run_load(tandem_liquid_main, argc, argv, program, solver);
}

}  // namespace tandem::participant
#endif
