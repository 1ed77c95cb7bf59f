/* The participant kit of tandem: write a solver, fill in a table of functions, and call tandem_motion_main(),
 * tandem_load_main() or tandem_liquid_main(). The library speaks the protocol, checks every value in both directions, and calls the
 * solver in a fixed order:
 *   configure, then any sequence of { predict, advance, save, restore, observe, ... }, then report.
 *
 * There are two kinds of solvers. A motion solver (multibody side, `--mbd-server`) takes loads and returns the
 * motion of the boundary bodies, which are the bodies with walls. A load solver takes that motion and returns
 * loads: of spheres (`--dem-server`) or of a liquid (`--sph-server`). Both fill in the same table; lines marked
 * "spheres" or "liquid" are for the one only, and are zero or NULL for the other.
 *
 * Units are SI, axes are the world's, unless a line says otherwise. A body's frame has its origin at the centre
 * of mass. Quaternions are unit, w x y z, and rotate vectors of the body frame into the world. A load is that of
 * the particles or the liquid ON the body; a torque is about the body's centre of mass. Time at the interface is in integer
 * nanoseconds since the start of the run.
 *
 * Results: the library hands each function a struct with room for the answer, zeroed, with `body`, `window` and
 * `time` already filled in; the function fills in the rest. Functions return TANDEM_OK, or the value of
 * tandem_fail(), which ends the run on all sides with that sentence.
 *
 * Stability (docs/participant.md): a program built with this header runs with every later libtandem_participant
 * of the same SOVERSION. Structs that the library fills may grow at their ends; tables that a program fills
 * begin with their size; arrays have elements that never change. */
#ifndef TANDEM_PARTICIPANT_H
#define TANDEM_PARTICIPANT_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define TANDEM_API __attribute__((visibility("default")))
#else
#define TANDEM_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define TANDEM_GROUND 0xffffffffu

/* ---- results of functions */

#define TANDEM_OK 0
/* Error codes for tandem_fail(). */
#define TANDEM_ERROR_INTERNAL 1 /* a defect of the solver */
#define TANDEM_ERROR_SCENE 3    /* the scene is wrong, or asks for what this solver does not know */
#define TANDEM_ERROR_NUMERICS 7 /* the solver cannot continue */
#define TANDEM_ERROR_RESOURCE 8 /* memory, device, disk */

/* Ends the run with an error: what is wrong with its value, where (a key of the scene, a function), and what to
 * write instead. `where` and `hint` may be NULL. Returns a value for the calling function to return. */
TANDEM_API int tandem_fail(int code, const char *what, const char *where, const char *hint);
/* Writes a line to the log of the run: level 'i' information, 'w' warning. Warnings do not reach the summary;
 * use tandem_warn() in a function that has facts. */
TANDEM_API void tandem_log(char level, const char *sentence);

/* ---- messages: the layout of the protocol, see docs/protocol.md */

typedef struct tandem_pose {
  double position[3];   /* of the centre of mass [m] */
  double quaternion[4]; /* w x y z [-] */
} tandem_pose;

typedef struct tandem_twist {
  double velocity[3];         /* of the centre of mass [m/s] */
  double angular_velocity[3]; /* [rad/s] */
} tandem_twist;

typedef struct tandem_wrench {
  double force[3];  /* [N] */
  double torque[3]; /* about the centre of mass [N m] */
} tandem_wrench;

typedef struct tandem_window {
  uint64_t index; /* counts accepted windows from 0 */
  int64_t begin;  /* [ns] */
  int64_t end;    /* [ns] */
} tandem_window;

typedef struct tandem_body_motion { /* of one boundary body over one window */
  uint32_t body;                    /* index in the scene */
  uint32_t reserved;                /* 0 */
  tandem_pose begin_pose, end_pose;
  tandem_twist begin_twist, end_twist;
  double begin_acceleration[3], end_acceleration[3];                 /* of the centre of mass [m/s2] */
  double begin_angular_acceleration[3], end_angular_acceleration[3]; /* [rad/s2] */
  tandem_wrench applied_impulse; /* load used, integrated over the window [N s] [N m s]; 0 in a prediction */
  double applied_work;           /* done by that load along the path [J]; 0 in a prediction */
} tandem_body_motion;

typedef struct tandem_body_load { /* on one boundary body, or the ground, over one window */
  uint32_t body;                  /* index in the scene, or TANDEM_GROUND */
  uint32_t reserved;              /* 0 */
  tandem_wrench mean;             /* time mean over the window */
  tandem_wrench first_moment;     /* (1/H) integral of (t - t_mid) F dt [N s] [N m s]; 0 if not known */
  tandem_wrench end;              /* at the end of the window */
  double work;                    /* done by the particles on the body [J] */
} tandem_body_load;

typedef struct tandem_body_tangent { /* dF = -stiffness dx - damping dv, dx = (displacement, rotation) */
  uint32_t body;                     /* index in the scene */
  uint32_t reserved;                 /* 0 */
  double stiffness[36];              /* rows: force, torque */
  double damping[36];
} tandem_body_tangent;

/* A liquid resists a step of the body's velocity by dv: until `time` after it the impulse -impulse dv. For a flat wall this
 * begins as density * speed of sound * area * time, and ends as the added mass; at a time of 0 without sound. */
typedef struct tandem_body_response {
  uint32_t body;      /* index in the scene */
  uint32_t reserved;  /* 0 */
  double time;        /* [s] */
  double impulse[36]; /* rows: force, torque */
} tandem_body_response;

typedef struct tandem_particle_account { /* balance of the particles over one window */
  uint64_t micro_steps;                  /* in this window, at least 1 */
  double micro_step;                     /* H / micro_steps [s] */
  double momentum_begin[3];              /* sum of m v [kg m/s] */
  double momentum_end[3];
  double gravity_impulse[3];     /* [N s] */
  double lost_momentum[3];       /* of particles that left, less that of those that entered [kg m/s] */
  double kinetic_energy;         /* at the end [J] */
  double largest_overlap_ratio;  /* overlap / smaller radius, since the start [-] */
  uint64_t lost_particles;       /* since the start */
  uint64_t contacts;             /* between particles, at the end */
  uint64_t neighbour_list_builds; /* since the start */
} tandem_particle_account;

typedef struct tandem_body_state {
  uint32_t body, reserved;
  tandem_pose pose;
  tandem_twist twist;
} tandem_body_state;

typedef struct tandem_joint_state {
  uint32_t joint;
  uint32_t undetermined;  /* bits 0 to 2 force x y z, 3 to 5 torque x y z: not determined by rigid mechanics */
  double coordinate;      /* revolute [rad], prismatic [m], else 0 */
  double rate;            /* [rad/s] or [m/s] */
  tandem_wrench reaction; /* of the joint on the child; torque about the joint's point [N] [N m] */
} tandem_joint_state;

/* ---- sets of messages */

typedef struct tandem_motion_set {
  tandem_window window;
  size_t count; /* number of boundary bodies */
  tandem_body_motion *bodies;
} tandem_motion_set;

typedef struct tandem_load_set {
  tandem_window window;
  tandem_particle_account account;
  size_t count; /* number of loads: of boundary bodies, and of the ground where it has walls */
  tandem_body_load *bodies;
} tandem_load_set;

typedef struct tandem_tangent_set {
  int64_t time; /* [ns] */
  size_t count;
  tandem_body_tangent *bodies;
  size_t response_count; /* with TANDEM_CAN_RESPOND: points of responses by body and time, an array of the solver */
  const tandem_body_response *responses;
} tandem_tangent_set;

typedef struct tandem_bodies_frame { /* for the results */
  int64_t time;                      /* [ns] */
  size_t body_count, joint_count;
  tandem_body_state *bodies;  /* all bodies of the scene */
  tandem_joint_state *joints; /* all joints of the scene */
  double energy;              /* kinetic and potential, of bodies and springs [J] */
  size_t element_count;       /* with TANDEM_CAN_OBSERVE_ELEMENTS: that of the configuration; else 0 */
  double *elements;           /* values of these columns */
} tandem_bodies_frame;

typedef struct tandem_particles_frame { /* for the results: pointers to arrays of the solver */
  int64_t time;                         /* [ns] */
  size_t count;
  const uint32_t *id;     /* ascending (count) */
  const double *position; /* [m] (count x 3) */
  const float *velocity;  /* [m/s] (count x 3) */
  const float *spin;      /* spheres [rad/s] (count x 3) */
  const float *radius;    /* spheres [m] (count) */
  const float *pressure;  /* liquid, with TANDEM_CAN_OBSERVE_LIQUID [Pa] (count) */
  const float *density;   /* likewise [kg/m3] (count) */
} tandem_particles_frame;

typedef struct tandem_control_set { /* values of the control inputs from now on, in the order of the scene */
  int64_t time;                     /* [ns] */
  size_t count;
  const double *values; /* [N m] or [N] */
} tandem_control_set;

typedef struct tandem_state_file {
  uint64_t windows; /* number of completed windows */
  int64_t time;     /* [ns] */
  const char *path; /* on this host */
} tandem_state_file;

/* ---- the scene, as far as nearly every solver needs it */

typedef struct tandem_body {
  const char *name;
  double mass;        /* [kg] */
  double inertia[9];  /* about the centre of mass, axes of the body, by rows [kg m2] */
  tandem_pose pose;   /* at the start */
  tandem_twist twist; /* at the start; that of a body with joints follows from its joints */
  uint32_t is_boundary; /* 1: the body has walls */
  uint32_t is_free;     /* 1: the body has neither joints nor forces */
} tandem_body;

typedef struct tandem_material {
  const char *name;
  double density; /* [kg/m3] */
  double young;   /* [Pa] */
  double poisson; /* [-] */
} tandem_material;

/* Of two materials in contact. The library has combined what the scene gives for the materials alone. Constants
 * of laws other than the scene's have no meaning. */
typedef struct tandem_pair {
  uint32_t a, b;                  /* indices in materials */
  double restitution;             /* [-] */
  double friction;                /* [-] */
  double rolling_friction;        /* with contact.rolling [-] */
  double rolling_damping;         /* with contact.rolling, share of the critical one [-] */
  double spring_stiffness;        /* contact:hooke [N/m] */
  double spring_ratio;            /* contact:hooke, tangential to normal [-] */
  double work_of_adhesion;        /* contact:jkr [J/m2] */
  double cohesion_energy_density; /* contact:sjkr [J/m3] */
  double normal_stiffness;        /* contact:paper [N/m^1.5] */
  double normal_damping;          /* contact:paper [N s/m^1.25] */
  double tangential_stiffness;    /* contact:paper [N/m^1.5] */
  double tangential_damping;      /* contact:paper [N s/m^1.25] */
} tandem_pair;

#define TANDEM_WALL_PLANE 0    /* solid on the side opposite to the normal */
#define TANDEM_WALL_MESH 1     /* triangles: mesh, box, and cylinder with `segments` */
#define TANDEM_WALL_CYLINDER 2 /* smooth surface about the z axis of `pose` */
#define TANDEM_WALL_SPHERE 3   /* smooth surface about the origin of `pose` */

typedef struct tandem_wall {
  const char *name;
  uint32_t body;     /* index in the scene, or TANDEM_GROUND */
  uint32_t material; /* index in materials */
  uint32_t shape;    /* TANDEM_WALL_... */
  uint32_t open;     /* cylinder: bit 0 without the end at -z, bit 1 without the end at +z */
  tandem_pose pose;  /* of the shape's frame in the body's frame; of the ground: in the world */
  double point[3];   /* plane, in the frame of the body [m] */
  double normal[3];  /* plane, in the frame of the body, unit [-] */
  double radius;     /* cylinder, sphere [m] */
  double height;     /* cylinder [m]; infinite without ends */
  size_t triangle_count;
  const double *triangles; /* vertices in the frame of the body [m] (triangle_count x 3 x 3) */
} tandem_wall;

/* Each is filled at the start by boxes; those of `inside` are in `scene` (feature `liquid.inside`). */
typedef struct tandem_liquid {
  const char *name;
  double density;       /* [kg/m3] */
  double viscosity;     /* dynamic [Pa s] */
  double sound_speed;   /* of the computation; 0: the solver chooses [m/s] */
  double velocity[3];   /* at the start; 0 where the scene has none: it starts with its vessel [m/s] */
  uint32_t hydrostatic; /* 1: starts with the pressure of its weight, 0: without pressure */
  uint32_t reserved;
  size_t box_count;
  const double *boxes;  /* lower and upper corner, edges along the axes of the world [m] (box_count x 2 x 3) */
} tandem_liquid;

/* All pointers stay valid until the program ends. */
typedef struct tandem_configuration {
  const char *scene;          /* the scene file's text (JSON): what the fields below do not contain */
  const char *origin;         /* its path, for messages */
  const char *solver_options; /* JSON object of the scene for this solver; "{}" if the scene has none */
  const char *backend;        /* of a load solver: "auto", "cpu", "cuda" */
  uint32_t threads;           /* 0: the solver chooses */
  uint32_t reserved;
  double gravity[3];          /* [m/s2] */
  double end_time;            /* [s] */
  double window;              /* length of a window, or of the first one [s] */
  double micro_step;          /* dem.micro_step or sph.micro_step: the longest step; 0: the solver chooses [s] */
  size_t body_count;
  const tandem_body *bodies;
  size_t joint_count;         /* joints of the scene; their data are in `scene` */
  size_t boundary_count;
  const uint32_t *boundary;   /* indices of the boundary bodies, ascending */
  size_t material_count;      /* spheres */
  const tandem_material *materials;
  size_t pair_count;          /* spheres */
  const tandem_pair *pairs;
  size_t wall_count;          /* of the part of the scene for this solver; of a motion solver: dem.walls */
  const tandem_wall *walls;
  size_t sphere_count;             /* spheres: at the start; spheres of inlets come later and are not among them */
  const double *sphere_position;   /* [m] (sphere_count x 3) */
  const double *sphere_velocity;   /* [m/s] (sphere_count x 3) */
  const double *sphere_radius;     /* [m] (sphere_count) */
  const uint32_t *sphere_material; /* index in materials (sphere_count) */
  double domain_min[3], domain_max[3]; /* spheres that leave it are removed and counted; so are particles of a liquid [m] */
  size_t control_count;            /* number of control inputs */
  size_t element_count;            /* number of columns of elements.csv */
  const char *const *element_columns; /* their names, "drive.torque" (docs/results.md) */
  const double *sphere_spin;       /* angular velocities at the start [rad/s] (sphere_count x 3) */
  double spacing;                  /* liquid: edge of the cube that a particle fills at the start [m] */
  size_t liquid_count;             /* liquid */
  const tandem_liquid *liquids;
} tandem_configuration;

/* Figures for summary.json, from configure and report. A key gets the prefix "mbd_" or "dem_" of the solver's role; those of a
 * liquid are in the object "sph". It has 1
 * to 100 letters, digits, '_' and '-'; numbers are finite; there may be 20,000 facts and warnings of 4 MiB in all. Others
 * end the run. */
typedef struct tandem_facts tandem_facts;
TANDEM_API void tandem_fact_number(tandem_facts *facts, const char *key, double value);
TANDEM_API void tandem_fact_text(tandem_facts *facts, const char *key, const char *value);
/* A sentence for the warnings of the summary. */
TANDEM_API void tandem_warn(tandem_facts *facts, const char *sentence);

/* ---- capabilities: which schemes of coupling the solver can take part in */

#define TANDEM_CAN_PREDICT (1u << 0)     /* motion: predict() */
#define TANDEM_CAN_ROLLBACK (1u << 1)    /* save() and restore() */
#define TANDEM_CAN_INTERPOLATE (1u << 2) /* load: walls follow pose and twist inside the window */
#define TANDEM_CAN_WINDOW_MEAN (1u << 3) /* load: `mean` is the time mean over the window, not the end value */
#define TANDEM_CAN_LINEARISE (1u << 4)   /* load: linearise() */
#define TANDEM_CAN_EXTRAPOLATE (1u << 5) /* motion: extrapolate(); advance() integrates loads linear in time */
#define TANDEM_CAN_CONTROL (1u << 6)     /* motion: control() */
#define TANDEM_CAN_CHECKPOINT (1u << 7)  /* checkpoint() and resume() */
#define TANDEM_CAN_OBSERVE_ELEMENTS (1u << 8) /* motion: observe() fills in `elements` */
#define TANDEM_CAN_OBSERVE_LIQUID (1u << 13) /* liquid: observe() gives `pressure` and `density` */
#define TANDEM_CAN_RESPOND (1u << 14) /* load: linearise() fills in `responses`, also before the first window */

/* ---- the two tables. `self` is the pointer given to the main function. Functions that belong to a capability
 * which the table does not state may be NULL; all others must be given. */

typedef struct tandem_motion_solver {
  size_t size;           /* sizeof(tandem_motion_solver) */
  uint64_t capabilities; /* TANDEM_CAN_... */
  /* Names of the features of scenes that this solver knows, with NULL at the end; "joint:*" knows all that begin
   * with "joint:". The library refuses a scene with any other feature, by name (docs/participant.md lists them). */
  const char *const *features;
  /* `initial` has the pose and twist of the scene; a solver whose joints change them, or that knows the
   * accelerations, fills those in: begin = end = state at t = 0. */
  int (*configure)(void *self, const tandem_configuration *configuration, tandem_motion_set *initial,
                   tandem_facts *facts);
  /* Integrates the window under these mean loads; bodies that are not in the set have none. */
  int (*advance)(void *self, const tandem_load_set *loads, tandem_motion_set *motion);
  int (*observe)(void *self, tandem_bodies_frame *frame);
  int (*report)(void *self, tandem_facts *facts);
  /* Path over the window with the velocities held; the state does not change. */
  int (*predict)(void *self, const tandem_window *window, tandem_motion_set *motion);
  int (*save)(void *self);    /* keeps one copy of the whole state */
  int (*restore)(void *self); /* goes back to it; may be called more than once per save() */
  int (*extrapolate)(void *self, const tandem_window *window, tandem_motion_set *motion);
  int (*control)(void *self, const tandem_control_set *inputs);
  int (*checkpoint)(void *self, const tandem_state_file *file); /* the same state in a file */
  int (*resume)(void *self, const tandem_state_file *file);     /* after configure() */
} tandem_motion_solver;

typedef struct tandem_load_solver {
  size_t size;                 /* sizeof(tandem_load_solver) */
  uint64_t capabilities;       /* TANDEM_CAN_... */
  const char *const *features; /* as in tandem_motion_solver */
  int (*configure)(void *self, const tandem_configuration *configuration, tandem_facts *facts);
  /* Integrates the window along this motion. */
  int (*advance)(void *self, const tandem_motion_set *motion, tandem_load_set *loads);
  int (*observe)(void *self, tandem_particles_frame *frame);
  int (*report)(void *self, tandem_facts *facts);
  int (*save)(void *self);
  int (*restore)(void *self);
  int (*linearise)(void *self, tandem_tangent_set *tangents);
  int (*checkpoint)(void *self, const tandem_state_file *file);
  int (*resume)(void *self, const tandem_state_file *file);
} tandem_load_solver;

/* The main function of a participant: command line (--shm, --stream, --dds ... as of tandem's own servers),
 * log, protocol. `program` is name and version, "my_solver 1.2". Returns the exit status. */
TANDEM_API int tandem_motion_main(int argc, char **argv, const char *program, const tandem_motion_solver *solver,
                                  void *self);
TANDEM_API int tandem_load_main(int argc, char **argv, const char *program, const tandem_load_solver *solver,
                                void *self);
TANDEM_API int tandem_liquid_main(int argc, char **argv, const char *program, const tandem_load_solver *solver,
                                  void *self);

/* ---- help */

/* Pose and twist of a body `seconds` after the begin of the window: cubic in time, as tandem's own particle
 * solver follows it. Fails where the body rotates by more than 0.5 rad in the window. */
TANDEM_API int tandem_pose_at(const tandem_body_motion *motion, const tandem_window *window, double seconds,
                              tandem_pose *pose, tandem_twist *twist);

/* Version of the library: "0.1.0". */
TANDEM_API const char *tandem_participant_version(void);

#ifdef __cplusplus
}
#endif
#endif
