/* @NAME@: a multibody solver for tandem, in C. Free rigid bodies under gravity and the load of the particles.
 *
 * Over a window of length H with the mean load F, T: velocity and angular momentum change by exactly F H + m
 * g H and T H, and the position by H times the mean of the velocities at both ends, which is exact for a
 * constant force. The orientation follows from the implicit midpoint rule: the body turns by H w, where w is
 * the angular velocity that belongs to the mean angular momentum at the orientation half-way.
 * docs/participant.md of tandem says what each function must do. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <tandem/participant.h>

typedef struct Body {
  double x[3], q[4]; /* pose */
  double v[3], L[3]; /* velocity, angular momentum about the centre of mass, world axes */
} Body;

typedef struct Solver {
  const tandem_configuration* scene;
  double* inverse; /* of the inertia, axes of the body, by rows (bodies x 9) */
  Body *now, *saved;
} Solver;

static double dot(const double* a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static void cross(const double* a, const double* b, double* c) {
  c[0] = a[1] * b[2] - a[2] * b[1], c[1] = a[2] * b[0] - a[0] * b[2], c[2] = a[0] * b[1] - a[1] * b[0];
}
static void times(const double* m, const double* v, double* out) {
  for (int i = 0; i < 3; ++i) out[i] = dot(m + 3 * i, v);
}
/* Rotates by the quaternion q, or for `sign` = -1 by its inverse. */
static void rotate(const double* q, double sign, const double* v, double* out) {
  const double u[3] = {sign * q[1], sign * q[2], sign * q[3]};
  double a[3], b[3];
  cross(u, v, a);
  cross(u, a, b);
  for (int k = 0; k < 3; ++k) out[k] = v[k] + 2 * (q[0] * a[k] + b[k]);
}
/* q turned by the rotation vector `factor` w, world axes; of unit length again. */
static void turned(const double* q, double factor, const double* w, double* out) {
  const double angle = fabs(factor) * sqrt(dot(w, w));
  const double s = angle > 0 ? factor * sin(0.5 * angle) / angle : 0.5 * factor, c = cos(0.5 * angle);
  const double u[3] = {s * w[0], s * w[1], s * w[2]};
  const double made[4] = {c * q[0] - dot(u, q + 1), c * q[1] + u[0] * q[0] + u[1] * q[3] - u[2] * q[2],
                          c * q[2] + u[1] * q[0] + u[2] * q[1] - u[0] * q[3],
                          c * q[3] + u[2] * q[0] + u[0] * q[2] - u[1] * q[1]};
  const double norm = sqrt(made[0] * made[0] + dot(made + 1, made + 1));
  for (int k = 0; k < 4; ++k) out[k] = made[k] / norm;
}
/* The angular velocity of body b with angular momentum L at the orientation q. */
static void angular_velocity(const Solver* s, size_t b, const double* q, const double* L, double* w) {
  double in_body[3], w_body[3];
  rotate(q, -1, L, in_body);
  times(s->inverse + 9 * b, in_body, w_body);
  rotate(q, 1, w_body, w);
}
/* The angular acceleration under the torque T: I w' = T - w x L. */
static void angular_acceleration(const Solver* s, size_t b, const double* q, const double* L, const double* T,
                                 double* out) {
  double w[3], gyroscopic[3];
  angular_velocity(s, b, q, L, w);
  cross(w, L, gyroscopic);
  for (int k = 0; k < 3; ++k) gyroscopic[k] = T[k] - gyroscopic[k];
  angular_velocity(s, b, q, gyroscopic, out);
}

static void write_pose(const Body* body, tandem_pose* pose) {
  memcpy(pose->position, body->x, sizeof body->x), memcpy(pose->quaternion, body->q, sizeof body->q);
}
static void write_twist(const Solver* s, size_t b, const Body* body, tandem_twist* twist) {
  memcpy(twist->velocity, body->v, sizeof body->v);
  angular_velocity(s, b, body->q, body->L, twist->angular_velocity);
}

static int configure(void* self, const tandem_configuration* scene, tandem_motion_set* initial,
                     tandem_facts* facts) {
  Solver* s = self;
  const size_t n = scene->body_count;
  s->scene = scene;
  s->now = calloc(n, sizeof *s->now), s->saved = calloc(n, sizeof *s->saved),
  s->inverse = calloc(9 * n, sizeof(double));
  if (!s->now || !s->saved || !s->inverse)
    return tandem_fail(TANDEM_ERROR_RESOURCE, "no memory is left for the bodies", "mbd.bodies", "take fewer");
  for (size_t b = 0; b < n; ++b) {
    const tandem_body* body = scene->bodies + b;
    const double* I = body->inertia; /* symmetric: the cofactors by rows, divided by the determinant */
    double rows[9], w_body[3], L_body[3];
    cross(I + 3, I + 6, rows), cross(I + 6, I, rows + 3), cross(I, I + 3, rows + 6);
    const double determinant = dot(I, rows);
    for (int k = 0; k < 9; ++k) s->inverse[9 * b + k] = rows[k] / determinant;
    memcpy(s->now[b].x, body->pose.position, sizeof s->now[b].x);
    memcpy(s->now[b].q, body->pose.quaternion, sizeof s->now[b].q);
    memcpy(s->now[b].v, body->twist.velocity, sizeof s->now[b].v);
    rotate(s->now[b].q, -1, body->twist.angular_velocity, w_body);
    times(I, w_body, L_body);
    rotate(s->now[b].q, 1, L_body, s->now[b].L);
  }
  for (size_t i = 0; i < initial->count; ++i) { /* pose and twist are those of the scene already */
    tandem_body_motion* m = initial->bodies + i;
    const double none[3] = {0, 0, 0};
    memcpy(m->begin_acceleration, scene->gravity, sizeof scene->gravity);
    memcpy(m->end_acceleration, scene->gravity, sizeof scene->gravity);
    angular_acceleration(s, m->body, s->now[m->body].q, s->now[m->body].L, none,
                         m->begin_angular_acceleration);
    memcpy(m->end_angular_acceleration, m->begin_angular_acceleration, sizeof none);
  }
  tandem_fact_text(facts, "method", "free bodies, implicit midpoint rule");
  return TANDEM_OK;
}

/* Moves body b over the window; `motion` may be NULL for a body without walls. */
static int move(Solver* s, size_t b, double H, const tandem_wrench* load, tandem_body_motion* motion) {
  Body* body = s->now + b;
  const double mass = s->scene->bodies[b].mass;
  const Body old = *body;
  double a[3], moved[3], L_mid[3], w[3], change = 1;
  for (int k = 0; k < 3; ++k) {
    a[k] = load->force[k] / mass + s->scene->gravity[k];
    moved[k] = H * (old.v[k] + 0.5 * H * a[k]);
    body->x[k] += moved[k], body->v[k] += H * a[k], body->L[k] += H * load->torque[k];
    L_mid[k] = 0.5 * (old.L[k] + body->L[k]);
  }
  angular_velocity(s, b, old.q, L_mid, w);
  for (int i = 0; change > 1e-14; ++i) { /* each pass reduces the error by a factor of H |w| */
    double q_mid[4], next[3];
    if (i == 100)
      return tandem_fail(TANDEM_ERROR_NUMERICS, "the rotation of a body over a window has not been found",
                         s->scene->bodies[b].name, "take shorter windows");
    turned(old.q, 0.5 * H, w, q_mid);
    angular_velocity(s, b, q_mid, L_mid, next);
    change = 0;
    for (int k = 0; k < 3; ++k) change = fmax(change, H * fabs(next[k] - w[k])), w[k] = next[k];
  }
  turned(old.q, H, w, body->q);
  if (!motion) return TANDEM_OK;
  write_pose(&old, &motion->begin_pose), write_twist(s, b, &old, &motion->begin_twist);
  write_pose(body, &motion->end_pose), write_twist(s, b, body, &motion->end_twist);
  memcpy(motion->begin_acceleration, a, sizeof a), memcpy(motion->end_acceleration, a, sizeof a);
  angular_acceleration(s, b, old.q, old.L, load->torque, motion->begin_angular_acceleration);
  angular_acceleration(s, b, body->q, body->L, load->torque, motion->end_angular_acceleration);
  for (int k = 0; k < 3; ++k)
    motion->applied_impulse.force[k] = H * load->force[k],
    motion->applied_impulse.torque[k] = H * load->torque[k];
  motion->applied_work = dot(load->force, moved) + H * dot(load->torque, w);
  return TANDEM_OK;
}

static int advance(void* self, const tandem_load_set* loads, tandem_motion_set* motion) {
  Solver* s = self;
  const double H = (double)(motion->window.end - motion->window.begin) / 1e9;
  for (size_t b = 0; b < s->scene->body_count; ++b) {
    tandem_wrench load = {{0, 0, 0}, {0, 0, 0}};
    tandem_body_motion* answer = NULL;
    for (size_t i = 0; i < loads->count; ++i)
      if (loads->bodies[i].body == b) load = loads->bodies[i].mean;
    for (size_t i = 0; i < motion->count; ++i)
      if (motion->bodies[i].body == b) answer = motion->bodies + i;
    const int status = move(s, b, H, &load, answer);
    if (status != TANDEM_OK) return status;
  }
  return TANDEM_OK;
}

static int predict(void* self, const tandem_window* window, tandem_motion_set* motion) {
  const Solver* s = self;
  const double H = (double)(window->end - window->begin) / 1e9;
  for (size_t i = 0; i < motion->count; ++i) {
    tandem_body_motion* m = motion->bodies + i;
    const Body* body = s->now + m->body;
    Body end = *body;
    write_twist(s, m->body, body, &m->begin_twist);
    m->end_twist = m->begin_twist;
    for (int k = 0; k < 3; ++k) end.x[k] += H * body->v[k];
    turned(body->q, H, m->begin_twist.angular_velocity, end.q);
    write_pose(body, &m->begin_pose), write_pose(&end, &m->end_pose);
  }
  return TANDEM_OK;
}

static int observe(void* self, tandem_bodies_frame* frame) {
  const Solver* s = self;
  for (size_t b = 0; b < frame->body_count; ++b) {
    const double mass = s->scene->bodies[b].mass;
    const Body* body = s->now + b;
    tandem_twist* twist = &frame->bodies[b].twist;
    write_pose(body, &frame->bodies[b].pose), write_twist(s, b, body, twist);
    frame->energy += 0.5 * mass * dot(body->v, body->v) + 0.5 * dot(twist->angular_velocity, body->L) -
                     mass * dot(s->scene->gravity, body->x);
  }
  return TANDEM_OK;
}

static int report(void* self, tandem_facts* facts) {
  (void)self, (void)facts;
  return TANDEM_OK;
}
static int save(void* self) {
  Solver* s = self;
  memcpy(s->saved, s->now, s->scene->body_count * sizeof *s->now);
  return TANDEM_OK;
}
static int restore(void* self) {
  Solver* s = self;
  memcpy(s->now, s->saved, s->scene->body_count * sizeof *s->now);
  return TANDEM_OK;
}

int main(int argc, char** argv) {
  static const tandem_motion_solver table = {
      .size = sizeof table,
      .capabilities = TANDEM_CAN_PREDICT | TANDEM_CAN_ROLLBACK,
      .features = NULL, /* a scene with a joint or a force is refused */
      .configure = configure,
      .advance = advance,
      .observe = observe,
      .report = report,
      .predict = predict,
      .save = save,
      .restore = restore};
  static Solver solver;
  return tandem_motion_main(argc, argv, "@NAME@ 0.1", &table, &solver);
}
