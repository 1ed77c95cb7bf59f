// Which variant runs a scene.
#include "dem_server/engine/engine.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "dem_server/geometry/analytic_facets.hpp"

namespace tandem::dem {

// One pair of makers per line of contact_variants.def.
#define VARIANT(name, law, real)                                       \
  std::unique_ptr<Engine> make_##name##_cpu(const EngineSetup&);       \
  std::unique_ptr<Engine> make_##name##_cpu_count(const EngineSetup&); \
  std::unique_ptr<Engine> make_##name##_cuda(const EngineSetup&);      \
  std::unique_ptr<Engine> make_##name##_cuda_count(const EngineSetup&);
#include "contact_variants.inc"
#undef VARIANT

namespace {

// An engine, and what counts its memory.
struct Makers {
  std::unique_ptr<Engine> (*make)(const EngineSetup&);
  std::unique_ptr<Engine> (*count)(const EngineSetup&);
};
struct Variant {
  const char *name, *law, *real;
  Makers cpu, cuda;
  const Makers& of(Backend backend) const { return backend == Backend::cuda ? cuda : cpu; }
};

#if TANDEM_HAS_CUDA
#define CUDA_MAKERS(name) \
  { make_##name##_cuda, make_##name##_cuda_count }
#else
#define CUDA_MAKERS(name) \
  {}
#endif
constexpr Variant variants[] = {
#define VARIANT(name, law, real) \
  {#name, #law, #real, {make_##name##_cpu, make_##name##_cpu_count}, CUDA_MAKERS(name)},
#include "contact_variants.inc"
#undef VARIANT
};

const char* functor(scene::ContactLaw law) {
  switch (law) {
    case scene::ContactLaw::hertz_mindlin:
      return "HertzMindlin";
    case scene::ContactLaw::hertz_frictionless:
      return "HertzFrictionless";
    case scene::ContactLaw::paper:
      return "Paper";
    case scene::ContactLaw::hooke:
    case scene::ContactLaw::jkr:
    case scene::ContactLaw::sjkr:
      break;  // the generic variant's alone
  }
  return "";
}

const Variant* find(std::string_view law, std::string_view real) {
  for (const Variant& v : variants)
    if (law == v.law && real == v.real) return &v;
  return nullptr;
}

const Variant& variant_of(const EngineChoice& choice) {
  for (const Variant& v : variants)
    if (choice.variant == v.name) return v;
  throw Error(ErrorCode::internal, "no contact variant '" + choice.variant + "'");
}

}  // namespace

EngineChoice choose_engine(const scene::Scene& scene, Backend backend) {
  const scene::Dem& dem = *scene.dem;
  const char* real = dem.precision == scene::Precision::mixed ? "float" : "double";
  const bool periodic = std::ranges::find(dem.periodic, true) != dem.periodic.end();
  const bool extended = dem.force_generic || dem.rolling || dem.twisting || periodic;
  const Variant* special = extended ? nullptr : find(functor(dem.contact), real);
  EngineChoice choice;
  choice.backend = backend;
  choice.generic_fallback = special == nullptr;
  choice.variant = (special != nullptr ? special : find("GenericLaw", real))->name;
  if (dem.contact == scene::ContactLaw::hertz_frictionless && special != nullptr)
    choice.left_out = {"no friction: no tangential force", "no friction: no contact history",
                       "no friction: no spin"};
  const bool grids = std::ranges::any_of(dem.walls, [](const scene::Wall& wall) {
    return !is_analytic(wall.shape) || std::holds_alternative<scene::SphereShape>(wall.shape);
  });
  const bool fixed = std::ranges::any_of(dem.particles, &scene::ParticleGroup::fixed);
  if (!grids && !fixed) choice.left_out.push_back("no meshes: no facet grids");
  return choice;
}

std::size_t predicted_bytes(const EngineChoice& choice, const EngineSetup& setup, bool with_copy) {
  EngineSetup grown = setup;
  grown.neighbours = std::max(setup.neighbours, most_neighbours(setup.skins));
  grown.contacts = std::max(setup.contacts, most_contacts);
  grown.walls = std::max(setup.walls, most_walls);
  const std::unique_ptr<Engine> engine = variant_of(choice).of(choice.backend).count(grown);
  if (with_copy) engine->save();
  return engine->memory_bytes();
}

std::unique_ptr<Engine> make_engine(const EngineChoice& choice, const EngineSetup& setup) {
  return variant_of(choice).of(choice.backend).make(setup);
}

}  // namespace tandem::dem
