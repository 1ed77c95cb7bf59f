/* @NAME@: a particle solver for tandem, in C. Spheres with linear springs and dashpots, without friction and
 * therefore without rotation, against each other, planes and triangles. Velocity Verlet; docs/participant.md
 * of tandem says what each function must do. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <tandem/participant.h>

enum { most_contacts = 16 }; /* of one sphere with one wall */

typedef struct State { /* what save() keeps */
  size_t count;        /* spheres that are still in the domain */
  uint64_t lost;
  double largest_overlap;
  uint32_t *id, *material;
  double *x, *v, *radius, *mass; /* x and v: (count x 3) */
} State;

typedef struct Solver {
  const tandem_configuration* scene;
  State now, saved;
  double* force;                   /* (count x 3) */
  double* stiffness;               /* k of two materials (materials x materials); negative: no pair */
  double* damping;                 /* c / sqrt(m* k) of two materials */
  size_t* order;                   /* spheres by x */
  float *velocity, *spin, *radius; /* for observe() */
  uint64_t contacts;
} Solver;

static double dot(const double* a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static void cross(const double* a, const double* b, double* c) {
  c[0] = a[1] * b[2] - a[2] * b[1], c[1] = a[2] * b[0] - a[0] * b[2], c[2] = a[0] * b[1] - a[1] * b[0];
}
static void sub(const double* a, const double* b, double* c) {
  for (int k = 0; k < 3; ++k) c[k] = a[k] - b[k];
}
static void add(double* to, double factor, const double* v) {
  for (int k = 0; k < 3; ++k) to[k] += factor * v[k];
}
/* Rotates by the quaternion q, or for `sign` = -1 by its inverse. */
static void rotate(const double* q, double sign, const double* v, double* out) {
  const double u[3] = {sign * q[1], sign * q[2], sign * q[3]};
  double a[3], b[3];
  cross(u, v, a);
  cross(u, a, b);
  for (int k = 0; k < 3; ++k) out[k] = v[k] + 2 * (q[0] * a[k] + b[k]);
}

static int allocate(State* s, size_t count) {
  s->id = calloc(count, sizeof *s->id), s->material = calloc(count, sizeof *s->material);
  s->x = calloc(3 * count, sizeof *s->x), s->v = calloc(3 * count, sizeof *s->v);
  s->radius = calloc(count, sizeof *s->radius), s->mass = calloc(count, sizeof *s->mass);
  return count == 0 || (s->id && s->material && s->x && s->v && s->radius && s->mass);
}
static void copy(State* to, const State* from) {
  const size_t n = from->count;
  to->count = n, to->lost = from->lost, to->largest_overlap = from->largest_overlap;
  memcpy(to->id, from->id, n * sizeof *to->id),
      memcpy(to->material, from->material, n * sizeof *to->material);
  memcpy(to->x, from->x, 3 * n * sizeof *to->x), memcpy(to->v, from->v, 3 * n * sizeof *to->v);
  memcpy(to->radius, from->radius, n * sizeof *to->radius),
      memcpy(to->mass, from->mass, n * sizeof *to->mass);
}

static int configure(void* self, const tandem_configuration* scene, tandem_facts* facts) {
  Solver* s = self;
  const size_t n = scene->sphere_count, m = scene->material_count;
  s->scene = scene;
  s->force = calloc(3 * n, sizeof *s->force), s->order = calloc(n, sizeof *s->order);
  s->velocity = calloc(3 * n, sizeof *s->velocity), s->spin = calloc(3 * n, sizeof *s->spin);
  s->radius = calloc(n, sizeof *s->radius);
  s->stiffness = calloc(m * m, sizeof *s->stiffness), s->damping = calloc(m * m, sizeof *s->damping);
  if (!allocate(&s->now, n) || !allocate(&s->saved, n) || !s->stiffness || !s->damping ||
      (n > 0 && !(s->force && s->order && s->velocity && s->spin && s->radius)))
    return tandem_fail(TANDEM_ERROR_RESOURCE, "no memory is left for the spheres", "dem.particles",
                       "take fewer");
  if (!(scene->micro_step > 0))
    return tandem_fail(TANDEM_ERROR_SCENE, "no step of the particles is given", "dem.micro_step",
                       "give a number: this solver chooses none itself");
  for (size_t i = 0; i < m * m; ++i) s->stiffness[i] = -1;
  for (const tandem_pair* p = scene->pairs; p < scene->pairs + scene->pair_count; ++p) {
    if (p->friction != 0)
      return tandem_fail(TANDEM_ERROR_SCENE, "a pair has friction, which this solver does not know",
                         "dem.pairs", "write \"friction\": 0");
    const double l = p->restitution > 0 ? log(p->restitution) : 0, pi = acos(-1.0);
    s->stiffness[p->a * m + p->b] = s->stiffness[p->b * m + p->a] = p->spring_stiffness;
    s->damping[p->a * m + p->b] = s->damping[p->b * m + p->a] =
        p->restitution > 0 ? -2 * l / sqrt(l * l + pi * pi) : 2;
  }
  s->now.count = n;
  if (n > 0) {
    memcpy(s->now.x, scene->sphere_position, 3 * n * sizeof(double));
    memcpy(s->now.v, scene->sphere_velocity, 3 * n * sizeof(double));
    memcpy(s->now.radius, scene->sphere_radius, n * sizeof(double));
    memcpy(s->now.material, scene->sphere_material, n * sizeof(uint32_t));
  }
  for (size_t i = 0; i < n; ++i) {
    const double r = s->now.radius[i];
    s->now.id[i] = (uint32_t)i;
    s->now.mass[i] = 4.0 / 3 * acos(-1.0) * r * r * r * scene->materials[s->now.material[i]].density;
  }
  tandem_fact_text(facts, "method", "velocity Verlet, pairs by sweeping along x");
  return TANDEM_OK;
}

/* Normal force at an overlap > 0; `speed` is that of separation. Fails for materials without a pair. */
static int normal_force(Solver* s, uint32_t a, uint32_t b, double mass, double radius, double overlap,
                        double speed, double* force) {
  const size_t at = a * s->scene->material_count + b;
  const double k = s->stiffness[at];
  if (k < 0)
    return tandem_fail(TANDEM_ERROR_SCENE, "two materials without a pair are in contact", "dem.pairs",
                       "add the pair");
  *force = k * overlap - s->damping[at] * sqrt(mass * k) * speed;
  if (overlap / radius > s->now.largest_overlap) s->now.largest_overlap = overlap / radius;
  return TANDEM_OK;
}

static int before(const double* x, size_t a, size_t b) {
  return x[3 * a] < x[3 * b] || (x[3 * a] == x[3 * b] && a < b);
}

/* Forces between spheres. Sorted by x, a sphere has its partners close behind it. */
static int pair_forces(Solver* s) {
  const State* n = &s->now;
  double largest = 0;
  s->contacts = 0;
  for (size_t i = 0; i < n->count; ++i) largest = fmax(largest, n->radius[i]);
  for (size_t i = 1; i < n->count; ++i)
    for (size_t j = i; j > 0 && before(n->x, s->order[j], s->order[j - 1]); --j) {
      const size_t swap = s->order[j];
      s->order[j] = s->order[j - 1], s->order[j - 1] = swap;
    }
  for (size_t p = 0; p < n->count; ++p)
    for (size_t q = p + 1; q < n->count; ++q) {
      const size_t i = s->order[p], j = s->order[q];
      if (n->x[3 * j] - n->x[3 * i] > n->radius[i] + largest) break;
      double d[3], u[3], f = 0;
      sub(n->x + 3 * i, n->x + 3 * j, d);
      const double distance = sqrt(dot(d, d)), overlap = n->radius[i] + n->radius[j] - distance;
      if (overlap <= 0 || distance == 0) continue;
      sub(n->v + 3 * i, n->v + 3 * j, u);
      const double mass = n->mass[i] * n->mass[j] / (n->mass[i] + n->mass[j]);
      const int status = normal_force(s, n->material[i], n->material[j], mass,
                                      fmin(n->radius[i], n->radius[j]), overlap, dot(u, d) / distance, &f);
      if (status != TANDEM_OK) return status;
      add(s->force + 3 * i, f / distance, d);
      add(s->force + 3 * j, -f / distance, d);
      ++s->contacts;
    }
  return TANDEM_OK;
}

/* The point of triangle t (3 vertices) next to p [Ericson, Real-Time Collision Detection, 2005,
 * section 5.1.5]. */
static void closest_point(const double* t, const double* p, double* out) {
  const double *a = t, *b = t + 3, *c = t + 6;
  double ab[3], ac[3], ap[3], bp[3], cp[3];
  sub(b, a, ab), sub(c, a, ac), sub(p, a, ap), sub(p, b, bp), sub(p, c, cp);
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  double v, w; /* out = a + v ab + w ac */
  if (d1 <= 0 && d2 <= 0)
    v = 0, w = 0;
  else if (d3 >= 0 && d4 <= d3)
    v = 1, w = 0;
  else if (vc <= 0 && d1 >= 0 && d3 <= 0)
    v = d1 / (d1 - d3), w = 0;
  else if (d6 >= 0 && d5 <= d6)
    v = 0, w = 1;
  else if (vb <= 0 && d2 >= 0 && d6 <= 0)
    v = 0, w = d2 / (d2 - d6);
  else if (va <= 0 && d4 >= d3 && d5 >= d6)
    w = (d4 - d3) / (d4 - d3 + d5 - d6), v = 1 - w;
  else
    v = vb / (va + vb + vc), w = vc / (va + vb + vc);
  for (int k = 0; k < 3; ++k) out[k] = a[k] + v * ab[k] + w * ac[k];
}

/* Points of a wall that a sphere at p touches, in the frame of the wall's body, with unit normals towards the
 * sphere. The deepest come first; further points in the tangent plane of one of them belong to the same face.
 */
static int contacts_of(const tandem_wall* wall, const double* p, double radius, double (*point)[3],
                       double (*normal)[3], double* overlap, int* count) {
  *count = 0;
  if (wall->shape == TANDEM_WALL_PLANE) {
    double d[3];
    sub(p, wall->point, d);
    overlap[0] = radius - dot(d, wall->normal);
    for (int k = 0; k < 3; ++k)
      normal[0][k] = wall->normal[k], point[0][k] = p[k] - (radius - overlap[0]) * normal[0][k];
    *count = overlap[0] > 0;
    return TANDEM_OK;
  }
  for (;;) {
    const int n = *count;
    double deepest = 0;
    if (n == most_contacts)
      return tandem_fail(TANDEM_ERROR_NUMERICS, "a sphere touches more than 16 faces of a wall", wall->name,
                         "take a coarser mesh, or smaller spheres");
    for (size_t t = 0; t < wall->triangle_count; ++t) {
      double c[3], d[3], e[3];
      closest_point(wall->triangles + 9 * t, p, c);
      sub(p, c, d);
      const double distance = sqrt(dot(d, d));
      if (radius - distance <= deepest || distance == 0) continue;
      int same_face = 0;
      for (int k = 0; k < n; ++k) sub(c, point[k], e), same_face |= fabs(dot(e, normal[k])) < 1e-6 * radius;
      if (same_face) continue;
      deepest = overlap[n] = radius - distance;
      for (int k = 0; k < 3; ++k) point[n][k] = c[k], normal[n][k] = d[k] / distance;
    }
    if (deepest == 0) return TANDEM_OK;
    ++*count;
  }
}

/* Force and torque of one body's walls; adds to the forces of the spheres, and the opposite to `load`. */
static int wall_forces(Solver* s, uint32_t body, const tandem_pose* pose, const tandem_twist* twist,
                       tandem_wrench* load) {
  State* n = &s->now;
  for (const tandem_wall* wall = s->scene->walls; wall < s->scene->walls + s->scene->wall_count; ++wall) {
    if (wall->body != body) continue;
    for (size_t i = 0; i < n->count; ++i) {
      double world[3], p[3], point[most_contacts][3], normal[most_contacts][3], overlap[most_contacts];
      int count;
      sub(n->x + 3 * i, pose->position, world);
      rotate(pose->quaternion, -1, world, p);
      int status = contacts_of(wall, p, n->radius[i], point, normal, overlap, &count);
      for (int c = 0; c < count && status == TANDEM_OK; ++c) {
        double arm[3], direction[3], u[3], torque[3], f = 0;
        rotate(pose->quaternion, 1, point[c], arm);
        rotate(pose->quaternion, 1, normal[c], direction);
        cross(twist->angular_velocity, arm, u);
        add(u, 1, twist->velocity);
        const double speed = dot(n->v + 3 * i, direction) - dot(u, direction);
        status =
            normal_force(s, n->material[i], wall->material, n->mass[i], n->radius[i], overlap[c], speed, &f);
        if (status != TANDEM_OK) break;
        add(s->force + 3 * i, f, direction);
        cross(arm, direction, torque);
        add(load->force, -f, direction);
        add(load->torque, -f, torque);
      }
      if (status != TANDEM_OK) return status;
    }
  }
  return TANDEM_OK;
}

static void remove_lost(Solver* s, double* momentum) {
  State* n = &s->now;
  size_t kept = 0;
  for (size_t i = 0; i < n->count; ++i) {
    int inside = 1;
    for (int k = 0; k < 3; ++k)
      inside &= n->x[3 * i + k] >= s->scene->domain_min[k] && n->x[3 * i + k] <= s->scene->domain_max[k];
    if (!inside) {
      add(momentum, n->mass[i], n->v + 3 * i);
      continue;
    }
    n->id[kept] = n->id[i], n->material[kept] = n->material[i], n->radius[kept] = n->radius[i],
    n->mass[kept] = n->mass[i];
    memmove(n->x + 3 * kept, n->x + 3 * i, 3 * sizeof(double)),
        memmove(n->v + 3 * kept, n->v + 3 * i, 3 * sizeof(double));
    ++kept;
  }
  n->lost += n->count - kept, n->count = kept;
}

static const tandem_body_motion* motion_of(const tandem_motion_set* set, uint32_t body) {
  for (size_t b = 0; b < set->count; ++b)
    if (set->bodies[b].body == body) return set->bodies + b;
  return NULL; /* the ground */
}

/* Verlet: half a kick, drift, forces, half a kick. The load of a body is the trapezoidal sum of the same
 * forces, so that the impulses of spheres and bodies are opposite to the last bit but round-off. */
static int advance(void* self, const tandem_motion_set* motion, tandem_load_set* loads) {
  Solver* s = self;
  State* n = &s->now;
  tandem_particle_account* account = &loads->account;
  const double length = (double)(motion->window.end - motion->window.begin) / 1e9;
  const double steps = ceil(length / s->scene->micro_step * (1 - 1e-12)), dt = length / steps;
  for (size_t i = 0; i < n->count; ++i) add(account->momentum_begin, n->mass[i], n->v + 3 * i);
  remove_lost(s, account->lost_momentum);
  for (size_t i = 0; i < n->count; ++i)
    s->order[i] = i, add(account->gravity_impulse, n->mass[i] * length, s->scene->gravity);
  for (double step = 0; step <= steps; ++step) {
    const double share =
        (step == 0 || step == steps ? 0.5 : 1) / steps; /* of the window, for the trapezoidal sum */
    memset(s->force, 0, 3 * n->count * sizeof(double));
    int status = pair_forces(s);
    for (size_t b = 0; b < loads->count && status == TANDEM_OK; ++b) {
      tandem_body_load* load = loads->bodies + b;
      tandem_pose pose = {{0, 0, 0}, {1, 0, 0, 0}};
      tandem_twist twist = {{0, 0, 0}, {0, 0, 0}};
      const tandem_body_motion* path = motion_of(motion, load->body);
      if (path) status = tandem_pose_at(path, &motion->window, step * dt, &pose, &twist);
      memset(&load->end, 0, sizeof load->end);
      if (status == TANDEM_OK) status = wall_forces(s, load->body, &pose, &twist, &load->end);
      add(load->mean.force, share, load->end.force), add(load->mean.torque, share, load->end.torque);
      const double arm = share * (step * dt - 0.5 * length);
      add(load->first_moment.force, arm, load->end.force),
          add(load->first_moment.torque, arm, load->end.torque);
      load->work += share * length *
                    (dot(load->end.force, twist.velocity) + dot(load->end.torque, twist.angular_velocity));
    }
    if (status != TANDEM_OK) return status;
    const double kick =
        share * length; /* half a step at both ends, else the second half of one and the first of the next */
    for (size_t i = 0; i < n->count; ++i) {
      add(n->v + 3 * i, kick / n->mass[i], s->force + 3 * i), add(n->v + 3 * i, kick, s->scene->gravity);
      if (step < steps) add(n->x + 3 * i, dt, n->v + 3 * i);
    }
  }
  for (size_t i = 0; i < n->count; ++i) {
    add(account->momentum_end, n->mass[i], n->v + 3 * i);
    account->kinetic_energy += 0.5 * n->mass[i] * dot(n->v + 3 * i, n->v + 3 * i);
  }
  account->micro_steps = (uint64_t)steps, account->micro_step = dt;
  account->largest_overlap_ratio = n->largest_overlap, account->lost_particles = n->lost,
  account->contacts = s->contacts;
  return TANDEM_OK;
}

static int observe(void* self, tandem_particles_frame* frame) {
  Solver* s = self;
  for (size_t i = 0; i < 3 * s->now.count; ++i) s->velocity[i] = (float)s->now.v[i];
  for (size_t i = 0; i < s->now.count; ++i) s->radius[i] = (float)s->now.radius[i];
  frame->count = s->now.count, frame->id = s->now.id, frame->position = s->now.x;
  frame->velocity = s->velocity, frame->spin = s->spin, frame->radius = s->radius;
  return TANDEM_OK;
}
static int report(void* self, tandem_facts* facts) {
  (void)self, (void)facts;
  return TANDEM_OK;
}
static int save(void* self) {
  copy(&((Solver*)self)->saved, &((Solver*)self)->now);
  return TANDEM_OK;
}
static int restore(void* self) {
  copy(&((Solver*)self)->now, &((Solver*)self)->saved);
  return TANDEM_OK;
}

int main(int argc, char** argv) {
  static const char* const features[] = {"contact:hooke", "wall:plane", "wall:triangles", NULL};
  static const tandem_load_solver table = {
      .size = sizeof table,
      .capabilities = TANDEM_CAN_ROLLBACK | TANDEM_CAN_INTERPOLATE | TANDEM_CAN_WINDOW_MEAN,
      .features = features,
      .configure = configure,
      .advance = advance,
      .observe = observe,
      .report = report,
      .save = save,
      .restore = restore};
  static Solver solver;
  return tandem_load_main(argc, argv, "@NAME@ 0.1", &table, &solver);
}
