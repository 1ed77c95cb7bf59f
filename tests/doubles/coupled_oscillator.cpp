#include "tests/doubles/coupled_oscillator.hpp"

#include "common/math/spectral_radius.hpp"

namespace tandem::test {

scene::Scene oscillator_scene(const OscillatorBodyParameters& body, const scene::Coupling& coupling) {
  scene::Scene scene;
  scene.name = "oscillator";
  scene.coupling = coupling;
  scene.mbd.emplace();
  scene.mbd->bodies.push_back({"mass", body.mass, {body.mass, body.mass, body.mass}, {}, {}});
  scene::Joint slide;
  slide.name = "slide";
  slide.type = scene::JointType::prismatic;
  slide.child = BodyId{0};
  slide.axis = {1, 0, 0};
  scene.mbd->joints.push_back(slide);
  scene.dem.emplace();
  return scene;
}

CoupledOscillator::CoupledOscillator(const OscillatorBodyParameters& body_parameters,
                                     const OscillatorBedParameters& bed_parameters,
                                     const scene::Coupling& coupling, Channel channel)
    : body(body_parameters),
      bed(bed_parameters),
      wall_(bed_parameters.mass == 0),
      run_(body, bed, oscillator_scene(body_parameters, coupling), "{}", channel) {}

double CoupledOscillator::growth(double length) {
  std::vector<double> map;  // by columns
  for (int column = 0; column < 6; ++column) {
    const auto unit = [column](int i) { return column == i ? 1.0 : 0.0; };
    body.x = unit(0), body.v = unit(1), body.force = unit(2);
    if (!wall_) bed.y = unit(3), bed.w = unit(4);
    protocol::BodyLoad held;
    held.mean.force.x = held.end.force.x = unit(5);
    coupler().exchange().load.bodies = {held};
    advance(length);
    const protocol::BodyLoad& load = exchange().load.bodies[0];
    const bool held_at_end = run_.scene().coupling.load == scene::LoadShape::end;
    map.insert(map.end(), {body.x, body.v, body.force, bed.y, bed.w,
                           held_at_end ? load.end.force.x : load.mean.force.x});
  }
  return spectral_radius(map);
}

}  // namespace tandem::test
