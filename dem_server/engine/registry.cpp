// Chooses the variant that runs a scene.
#include "dem_server/engine/engine.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "dem_server/engine/engine_memory.hpp"
#include "dem_server/laws/generic.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/backend/count.hpp"
#include "particles/geometry/analytic_facets.hpp"

namespace tandem::dem {

// One maker per line of contact_variants.def and back end.
#define VARIANT(name, law, real)                                 \
  std::unique_ptr<Engine> make_##name##_cpu(const EngineSetup&); \
  std::unique_ptr<Engine> make_##name##_cuda(const EngineSetup&);
#include "contact_variants.inc"
#undef VARIANT

namespace {

struct Variant {
  const char *name, *law, *real;
  bool belts;
  std::unique_ptr<Engine> (*make_cpu)(const EngineSetup&);
  std::unique_ptr<Engine> (*make_cuda)(const EngineSetup&);
  std::size_t (*bytes_cpu)(const EngineSetup&, bool with_copy);
  std::size_t (*bytes_cuda)(const EngineSetup&, bool with_copy);
};

// The size of an engine's arrays, without building the engine.
template <class BackEnd, class Law, class Real>
std::size_t count_bytes(const EngineSetup& setup, bool with_copy) {
  CountExec<BackEnd> exec;
  const auto parameters = make_parameters<Real>(setup.scene, setup.spheres, setup.skins.largest);
  EngineMemory<CountExec<BackEnd>, Law, Real> memory(exec, setup, parameters);
  if (with_copy) copy(exec, memory.now, memory.saved);
  return memory.bytes();
}

#if TANDEM_HAS_CUDA
#define CUDA_MAKER(name) make_##name##_cuda
#else
#define CUDA_MAKER(name) nullptr
#endif
constexpr Variant variants[] = {
#define VARIANT(name, law, real)      \
  {#name,                             \
   #law,                              \
   #real,                             \
   law::belts,                        \
   make_##name##_cpu,                 \
   CUDA_MAKER(name),                  \
   count_bytes<CpuTraits, law, real>, \
   count_bytes<CudaTraits, law, real>},
#include "contact_variants.inc"
#undef VARIANT
};

const char* functor(scene::ContactLaw law) {
  switch (law) {
#define LAW(name, Functor)      \
  case scene::ContactLaw::name: \
    return #Functor;
#include "dem_server/laws/laws.def"
#undef LAW
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
  const bool extended = dem.force_generic || dem.rolling || dem.twisting || periodic || has_sums(scene);
  const bool belts = std::ranges::any_of(
      dem.walls, [](const scene::Wall& wall) { return wall.surface_velocity.has_value(); });
  const std::string law = functor(dem.contact) + std::string(belts ? "WithBelts" : "");
  const Variant* special = extended ? nullptr : find(law, real);
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
  const Variant& variant = variant_of(choice);
  return (choice.backend == Backend::cuda ? variant.bytes_cuda : variant.bytes_cpu)(grown, with_copy);
}

std::unique_ptr<Engine> make_engine(const EngineChoice& choice, const EngineSetup& setup) {
  const Variant& variant = variant_of(choice);
  if (has_sums(setup.scene) && !choice.generic_fallback)
    throw Error(ErrorCode::internal,
                "the contact variant '" + choice.variant + "' has no sums of walls and energies");
  if (setup.surface.has_belts() && !variant.belts)
    throw Error(ErrorCode::internal, "the contact variant '" + choice.variant + "' has no belts");
  return (choice.backend == Backend::cuda ? variant.make_cuda : variant.make_cpu)(setup);
}

}  // namespace tandem::dem
