! The participant kit for Fortran 2008: compile this file with your solver and link tandem::participant. The header
! tandem/participant.h says what every struct and every call means; types, components and functions have the same
! names here. Unsigned numbers of C are signed ones of the same size: the ground is -1.
!
! A solver is a set of functions with bind(C); their addresses go into a tandem_motion_solver or a tandem_load_solver
! (by c_funloc), and tandem_motion_run, tandem_load_run (spheres) or tandem_liquid_run is the whole main program.
module tandem_participant
  use, intrinsic :: iso_c_binding
  implicit none
  public

  integer, parameter :: i32 = c_int32_t, i64 = c_int64_t, sz = c_size_t, dp = c_double
  private :: i32, i64, sz, dp

  integer(c_int32_t), parameter :: tandem_ground = -1_c_int32_t

  integer(c_int), parameter :: tandem_ok = 0
  integer(c_int), parameter :: tandem_error_internal = 1, tandem_error_scene = 3
  integer(c_int), parameter :: tandem_error_numerics = 7, tandem_error_resource = 8

  integer(c_int32_t), parameter :: tandem_wall_plane = 0, tandem_wall_mesh = 1
  integer(c_int32_t), parameter :: tandem_wall_cylinder = 2, tandem_wall_sphere = 3

  integer(c_int64_t), parameter :: tandem_can_predict = 1, tandem_can_rollback = 2, tandem_can_interpolate = 4
  integer(c_int64_t), parameter :: tandem_can_window_mean = 8, tandem_can_linearise = 16, tandem_can_extrapolate = 32
  integer(c_int64_t), parameter :: tandem_can_control = 64, tandem_can_checkpoint = 128
  integer(c_int64_t), parameter :: tandem_can_observe_elements = 256, tandem_can_observe_liquid = 8192, &
    tandem_can_respond = 16384

  ! ---- messages

  type, bind(C) :: tandem_pose
    real(dp) :: position(3), quaternion(4)
  end type
  type, bind(C) :: tandem_twist
    real(dp) :: velocity(3), angular_velocity(3)
  end type
  type, bind(C) :: tandem_wrench
    real(dp) :: force(3), torque(3)
  end type
  type, bind(C) :: tandem_window
    integer(i64) :: index, begin, end
  end type
  type, bind(C) :: tandem_body_motion
    integer(i32) :: body, reserved
    type(tandem_pose) :: begin_pose, end_pose
    type(tandem_twist) :: begin_twist, end_twist
    real(dp) :: begin_acceleration(3), end_acceleration(3)
    real(dp) :: begin_angular_acceleration(3), end_angular_acceleration(3)
    type(tandem_wrench) :: applied_impulse
    real(dp) :: applied_work
  end type
  type, bind(C) :: tandem_body_load
    integer(i32) :: body, reserved
    type(tandem_wrench) :: mean, first_moment, end
    real(dp) :: work
  end type
  type, bind(C) :: tandem_body_tangent
    integer(i32) :: body, reserved
    real(dp) :: stiffness(6, 6), damping(6, 6)  ! transposed: C has rows first
  end type
  type, bind(C) :: tandem_body_response
    integer(i32) :: body, reserved
    real(dp) :: time
    real(dp) :: impulse(6, 6)  ! transposed: C has rows first
  end type
  type, bind(C) :: tandem_particle_account
    integer(i64) :: micro_steps
    real(dp) :: micro_step
    real(dp) :: momentum_begin(3), momentum_end(3), gravity_impulse(3), lost_momentum(3)
    real(dp) :: kinetic_energy, largest_overlap_ratio
    integer(i64) :: lost_particles, contacts, neighbour_list_builds
  end type
  type, bind(C) :: tandem_body_state
    integer(i32) :: body, reserved
    type(tandem_pose) :: pose
    type(tandem_twist) :: twist
  end type
  type, bind(C) :: tandem_joint_state
    integer(i32) :: joint, undetermined
    real(dp) :: coordinate, rate
    type(tandem_wrench) :: reaction
  end type

  ! ---- sets of messages; tandem_motions(), tandem_loads() ... give their arrays

  type, bind(C) :: tandem_motion_set
    type(tandem_window) :: window
    integer(sz) :: count
    type(c_ptr) :: bodies
  end type
  type, bind(C) :: tandem_load_set
    type(tandem_window) :: window
    type(tandem_particle_account) :: account
    integer(sz) :: count
    type(c_ptr) :: bodies
  end type
  type, bind(C) :: tandem_tangent_set
    integer(i64) :: time
    integer(sz) :: count
    type(c_ptr) :: bodies
    integer(sz) :: response_count
    type(c_ptr) :: responses  ! by c_loc of an array of the solver
  end type
  type, bind(C) :: tandem_bodies_frame
    integer(i64) :: time
    integer(sz) :: body_count, joint_count
    type(c_ptr) :: bodies, joints
    real(dp) :: energy
    integer(sz) :: element_count
    type(c_ptr) :: elements
  end type
  type, bind(C) :: tandem_particles_frame
    integer(i64) :: time
    integer(sz) :: count
    type(c_ptr) :: id, position, velocity, spin, radius, pressure, density  ! by c_loc of arrays of the solver
  end type
  type, bind(C) :: tandem_control_set
    integer(i64) :: time
    integer(sz) :: count
    type(c_ptr) :: values
  end type
  type, bind(C) :: tandem_state_file
    integer(i64) :: windows, time
    type(c_ptr) :: path
  end type

  ! ---- the scene; texts are read by tandem_text()

  type, bind(C) :: tandem_body
    type(c_ptr) :: name
    real(dp) :: mass
    real(dp) :: inertia(3, 3)
    type(tandem_pose) :: pose
    type(tandem_twist) :: twist
    integer(i32) :: is_boundary, is_free
  end type
  type, bind(C) :: tandem_material
    type(c_ptr) :: name
    real(dp) :: density, young, poisson
  end type
  type, bind(C) :: tandem_pair
    integer(i32) :: a, b  ! indices count from 0
    real(dp) :: restitution, friction, rolling_friction, rolling_damping
    real(dp) :: spring_stiffness, spring_ratio, work_of_adhesion, cohesion_energy_density
    real(dp) :: normal_stiffness, normal_damping, tangential_stiffness, tangential_damping
  end type
  type, bind(C) :: tandem_wall
    type(c_ptr) :: name
    integer(i32) :: body, material, shape, open
    type(tandem_pose) :: pose
    real(dp) :: point(3), normal(3), radius, height
    integer(sz) :: triangle_count
    type(c_ptr) :: triangles
  end type
  type, bind(C) :: tandem_liquid
    type(c_ptr) :: name
    real(dp) :: density, viscosity, sound_speed, velocity(3)
    integer(i32) :: hydrostatic, reserved
    integer(sz) :: box_count
    type(c_ptr) :: boxes
  end type
  type, bind(C) :: tandem_configuration
    type(c_ptr) :: scene, origin, solver_options, backend
    integer(i32) :: threads, reserved
    real(dp) :: gravity(3), end_time, window, micro_step
    integer(sz) :: body_count
    type(c_ptr) :: bodies
    integer(sz) :: joint_count, boundary_count
    type(c_ptr) :: boundary
    integer(sz) :: material_count
    type(c_ptr) :: materials
    integer(sz) :: pair_count
    type(c_ptr) :: pairs
    integer(sz) :: wall_count
    type(c_ptr) :: walls
    integer(sz) :: sphere_count
    type(c_ptr) :: sphere_position, sphere_velocity, sphere_radius, sphere_material
    real(dp) :: domain_min(3), domain_max(3)
    integer(sz) :: control_count, element_count
    type(c_ptr) :: element_columns  ! array of texts, see tandem_element_column()
    type(c_ptr) :: sphere_spin
    real(dp) :: spacing
    integer(sz) :: liquid_count
    type(c_ptr) :: liquids
  end type

  ! ---- the tables; functions that are not given stay c_null_funptr. `size` and `features` are set by the run functions

  type, bind(C) :: tandem_motion_solver
    integer(sz) :: size = 0
    integer(i64) :: capabilities = 0
    type(c_ptr) :: features = c_null_ptr
    type(c_funptr) :: configure = c_null_funptr, advance = c_null_funptr, observe = c_null_funptr
    type(c_funptr) :: report = c_null_funptr, predict = c_null_funptr, save = c_null_funptr, restore = c_null_funptr
    type(c_funptr) :: extrapolate = c_null_funptr, control = c_null_funptr
    type(c_funptr) :: checkpoint = c_null_funptr, resume = c_null_funptr
  end type
  type, bind(C) :: tandem_load_solver
    integer(sz) :: size = 0
    integer(i64) :: capabilities = 0
    type(c_ptr) :: features = c_null_ptr
    type(c_funptr) :: configure = c_null_funptr, advance = c_null_funptr, observe = c_null_funptr
    type(c_funptr) :: report = c_null_funptr, save = c_null_funptr, restore = c_null_funptr
    type(c_funptr) :: linearise = c_null_funptr, checkpoint = c_null_funptr, resume = c_null_funptr
  end type

  ! tandem_c_... take texts of C; below are functions for texts of Fortran
  interface
    integer(c_int) function tandem_pose_at(motion, window, seconds, pose, twist) bind(C, name="tandem_pose_at")
      import :: c_int, tandem_body_motion, tandem_window, c_double, tandem_pose, tandem_twist
      type(tandem_body_motion), intent(in) :: motion
      type(tandem_window), intent(in) :: window
      real(c_double), value :: seconds
      type(tandem_pose), intent(out) :: pose
      type(tandem_twist), intent(out) :: twist
    end function
    integer(c_int) function tandem_c_motion_main(argc, argv, program, solver, self) bind(C, name="tandem_motion_main")
      import :: c_int, c_ptr, c_char, tandem_motion_solver
      integer(c_int), value :: argc
      type(c_ptr), intent(in) :: argv(*)
      character(kind=c_char), intent(in) :: program(*)
      type(tandem_motion_solver), intent(in) :: solver
      type(c_ptr), value :: self
    end function
    integer(c_int) function tandem_c_load_main(argc, argv, program, solver, self) bind(C, name="tandem_load_main")
      import :: c_int, c_ptr, c_char, tandem_load_solver
      integer(c_int), value :: argc
      type(c_ptr), intent(in) :: argv(*)
      character(kind=c_char), intent(in) :: program(*)
      type(tandem_load_solver), intent(in) :: solver
      type(c_ptr), value :: self
    end function
    integer(c_int) function tandem_c_liquid_main(argc, argv, program, solver, self) bind(C, name="tandem_liquid_main")
      import :: c_int, c_ptr, c_char, tandem_load_solver
      integer(c_int), value :: argc
      type(c_ptr), intent(in) :: argv(*)
      character(kind=c_char), intent(in) :: program(*)
      type(tandem_load_solver), intent(in) :: solver
      type(c_ptr), value :: self
    end function
    integer(c_int) function tandem_c_fail(code, what, where, hint) bind(C, name="tandem_fail")
      import :: c_int, c_char
      integer(c_int), value :: code
      character(kind=c_char), intent(in) :: what(*), where(*), hint(*)
    end function
    subroutine tandem_c_log(level, sentence) bind(C, name="tandem_log")
      import :: c_char
      character(kind=c_char), value :: level
      character(kind=c_char), intent(in) :: sentence(*)
    end subroutine
    subroutine tandem_c_fact_number(facts, key, number) bind(C, name="tandem_fact_number")
      import :: c_ptr, c_char, c_double
      type(c_ptr), value :: facts
      character(kind=c_char), intent(in) :: key(*)
      real(c_double), value :: number
    end subroutine
    subroutine tandem_c_fact_text(facts, key, text) bind(C, name="tandem_fact_text")
      import :: c_ptr, c_char
      type(c_ptr), value :: facts
      character(kind=c_char), intent(in) :: key(*), text(*)
    end subroutine
    subroutine tandem_c_warn(facts, sentence) bind(C, name="tandem_warn")
      import :: c_ptr, c_char
      type(c_ptr), value :: facts
      character(kind=c_char), intent(in) :: sentence(*)
    end subroutine
    type(c_ptr) function tandem_c_version() bind(C, name="tandem_participant_version")
      import :: c_ptr
    end function
    integer(c_size_t) function tandem_c_length(text) bind(C, name="strlen")
      import :: c_ptr, c_size_t
      type(c_ptr), value :: text
    end function
  end interface

  type :: text_for_c
    character(kind=c_char), allocatable :: bytes(:)
  end type
  private :: text_for_c, for_c, texts_for_c, own_command_line, exit_with, run_load

contains

  ! Ends the run with an error, as in C; where and hint may be ''.
  integer(c_int) function tandem_fail(code, what, where, hint) result(status)
    integer(c_int), intent(in) :: code
    character(*), intent(in) :: what, where, hint
    status = tandem_c_fail(code, what // c_null_char, where // c_null_char, hint // c_null_char)
  end function

  subroutine tandem_log(level, sentence)
    character(1), intent(in) :: level
    character(*), intent(in) :: sentence
    call tandem_c_log(level, sentence // c_null_char)
  end subroutine

  subroutine tandem_fact_number(facts, key, number)
    type(c_ptr), intent(in) :: facts
    character(*), intent(in) :: key
    real(c_double), intent(in) :: number
    call tandem_c_fact_number(facts, key // c_null_char, number)
  end subroutine

  subroutine tandem_fact_text(facts, key, text)
    type(c_ptr), intent(in) :: facts
    character(*), intent(in) :: key, text
    call tandem_c_fact_text(facts, key // c_null_char, text // c_null_char)
  end subroutine

  subroutine tandem_warn(facts, sentence)
    type(c_ptr), intent(in) :: facts
    character(*), intent(in) :: sentence
    call tandem_c_warn(facts, sentence // c_null_char)
  end subroutine

  function tandem_participant_version() result(version)
    character(:), allocatable :: version
    version = tandem_text(tandem_c_version())
  end function

  ! A text of C as one of Fortran; '' for a null pointer.
  function tandem_text(pointer) result(text)
    type(c_ptr), intent(in) :: pointer
    character(:), allocatable :: text
    character(kind=c_char), pointer :: bytes(:)
    integer :: i, length
    length = 0
    if (c_associated(pointer)) length = int(tandem_c_length(pointer))
    allocate (character(length) :: text)
    if (length == 0) return
    call c_f_pointer(pointer, bytes, [length])
    do i = 1, length
      text(i:i) = bytes(i)
    end do
  end function

  ! Length of a window [s].
  real(c_double) function tandem_length(window) result(seconds)
    type(tandem_window), intent(in) :: window
    seconds = real(window%end - window%begin, c_double) / 1e9_c_double
  end function

  ! The arrays of the structs; empty ones where a struct has none, for which C gives a null pointer.
  function tandem_motions(set) result(list)
    type(tandem_motion_set), intent(in) :: set
    type(tandem_body_motion), pointer :: list(:)
    type(tandem_body_motion), target, save :: none(1)
    list => none(1:0)
    if (set%count > 0) call c_f_pointer(set%bodies, list, [set%count])
  end function

  function tandem_loads(set) result(list)
    type(tandem_load_set), intent(in) :: set
    type(tandem_body_load), pointer :: list(:)
    type(tandem_body_load), target, save :: none(1)
    list => none(1:0)
    if (set%count > 0) call c_f_pointer(set%bodies, list, [set%count])
  end function

  function tandem_tangents(set) result(list)
    type(tandem_tangent_set), intent(in) :: set
    type(tandem_body_tangent), pointer :: list(:)
    type(tandem_body_tangent), target, save :: none(1)
    list => none(1:0)
    if (set%count > 0) call c_f_pointer(set%bodies, list, [set%count])
  end function

  function tandem_states(frame) result(list)
    type(tandem_bodies_frame), intent(in) :: frame
    type(tandem_body_state), pointer :: list(:)
    type(tandem_body_state), target, save :: none(1)
    list => none(1:0)
    if (frame%body_count > 0) call c_f_pointer(frame%bodies, list, [frame%body_count])
  end function

  function tandem_joints(frame) result(list)
    type(tandem_bodies_frame), intent(in) :: frame
    type(tandem_joint_state), pointer :: list(:)
    type(tandem_joint_state), target, save :: none(1)
    list => none(1:0)
    if (frame%joint_count > 0) call c_f_pointer(frame%joints, list, [frame%joint_count])
  end function

  function tandem_elements(frame) result(list)
    type(tandem_bodies_frame), intent(in) :: frame
    real(c_double), pointer :: list(:)
    real(c_double), target, save :: none(1)
    list => none(1:0)
    if (frame%element_count > 0) call c_f_pointer(frame%elements, list, [frame%element_count])
  end function

  ! Name of column number i of elements.csv, from 1 on.
  function tandem_element_column(configuration, i) result(name)
    type(tandem_configuration), intent(in) :: configuration
    integer, intent(in) :: i
    character(:), allocatable :: name
    type(c_ptr), pointer :: names(:)
    call c_f_pointer(configuration%element_columns, names, [configuration%element_count])
    name = tandem_text(names(i))
  end function

  function tandem_values(set) result(list)
    type(tandem_control_set), intent(in) :: set
    real(c_double), pointer :: list(:)
    real(c_double), target, save :: none(1)
    list => none(1:0)
    if (set%count > 0) call c_f_pointer(set%values, list, [set%count])
  end function

  function tandem_bodies(configuration) result(list)
    type(tandem_configuration), intent(in) :: configuration
    type(tandem_body), pointer :: list(:)
    type(tandem_body), target, save :: none(1)
    list => none(1:0)
    if (configuration%body_count > 0) call c_f_pointer(configuration%bodies, list, [configuration%body_count])
  end function

  function tandem_boundary(configuration) result(list)
    type(tandem_configuration), intent(in) :: configuration
    integer(c_int32_t), pointer :: list(:)
    integer(c_int32_t), target, save :: none(1)
    list => none(1:0)
    if (configuration%boundary_count > 0) call c_f_pointer(configuration%boundary, list, [configuration%boundary_count])
  end function

  function tandem_materials(configuration) result(list)
    type(tandem_configuration), intent(in) :: configuration
    type(tandem_material), pointer :: list(:)
    type(tandem_material), target, save :: none(1)
    list => none(1:0)
    if (configuration%material_count > 0) call c_f_pointer(configuration%materials, list, [configuration%material_count])
  end function

  function tandem_pairs(configuration) result(list)
    type(tandem_configuration), intent(in) :: configuration
    type(tandem_pair), pointer :: list(:)
    type(tandem_pair), target, save :: none(1)
    list => none(1:0)
    if (configuration%pair_count > 0) call c_f_pointer(configuration%pairs, list, [configuration%pair_count])
  end function

  function tandem_walls(configuration) result(list)
    type(tandem_configuration), intent(in) :: configuration
    type(tandem_wall), pointer :: list(:)
    type(tandem_wall), target, save :: none(1)
    list => none(1:0)
    if (configuration%wall_count > 0) call c_f_pointer(configuration%walls, list, [configuration%wall_count])
  end function

  ! Vertices of a wall: triangles(:, k, i) is vertex k of triangle i.
  function tandem_triangles(wall) result(list)
    type(tandem_wall), intent(in) :: wall
    real(c_double), pointer :: list(:, :, :)
    real(c_double), target, save :: none(3, 3, 1)
    list => none(:, :, 1:0)
    if (wall%triangle_count > 0) call c_f_pointer(wall%triangles, list, [3_c_size_t, 3_c_size_t, wall%triangle_count])
  end function

  function tandem_liquids(configuration) result(list)
    type(tandem_configuration), intent(in) :: configuration
    type(tandem_liquid), pointer :: list(:)
    type(tandem_liquid), target, save :: none(1)
    list => none(1:0)
    if (configuration%liquid_count > 0) call c_f_pointer(configuration%liquids, list, [configuration%liquid_count])
  end function

  ! Boxes that a liquid fills: boxes(:, 1, i) is the lower corner of box i, boxes(:, 2, i) the upper one.
  function tandem_boxes(liquid) result(list)
    type(tandem_liquid), intent(in) :: liquid
    real(c_double), pointer :: list(:, :, :)
    real(c_double), target, save :: none(3, 2, 1)
    list => none(:, :, 1:0)
    if (liquid%box_count > 0) call c_f_pointer(liquid%boxes, list, [3_c_size_t, 2_c_size_t, liquid%box_count])
  end function

  function tandem_sphere_position(configuration) result(list)
    type(tandem_configuration), intent(in) :: configuration
    real(c_double), pointer :: list(:, :)
    real(c_double), target, save :: none(3, 1)
    list => none(:, 1:0)
    if (configuration%sphere_count > 0) &
      call c_f_pointer(configuration%sphere_position, list, [3_c_size_t, configuration%sphere_count])
  end function

  function tandem_sphere_velocity(configuration) result(list)
    type(tandem_configuration), intent(in) :: configuration
    real(c_double), pointer :: list(:, :)
    real(c_double), target, save :: none(3, 1)
    list => none(:, 1:0)
    if (configuration%sphere_count > 0) &
      call c_f_pointer(configuration%sphere_velocity, list, [3_c_size_t, configuration%sphere_count])
  end function

  function tandem_sphere_spin(configuration) result(list)
    type(tandem_configuration), intent(in) :: configuration
    real(c_double), pointer :: list(:, :)
    real(c_double), target, save :: none(3, 1)
    list => none(:, 1:0)
    if (configuration%sphere_count > 0) &
      call c_f_pointer(configuration%sphere_spin, list, [3_c_size_t, configuration%sphere_count])
  end function

  function tandem_sphere_radius(configuration) result(list)
    type(tandem_configuration), intent(in) :: configuration
    real(c_double), pointer :: list(:)
    real(c_double), target, save :: none(1)
    list => none(1:0)
    if (configuration%sphere_count > 0) call c_f_pointer(configuration%sphere_radius, list, [configuration%sphere_count])
  end function

  function tandem_sphere_material(configuration) result(list)
    type(tandem_configuration), intent(in) :: configuration
    integer(c_int32_t), pointer :: list(:)
    integer(c_int32_t), target, save :: none(1)
    list => none(1:0)
    if (configuration%sphere_count > 0) call c_f_pointer(configuration%sphere_material, list, [configuration%sphere_count])
  end function

  ! The whole main program: ends with the exit status. `program` is name and version, 'my_solver 1.2'; blanks at the
  ! end of the features' names do not count.
  subroutine tandem_motion_run(program, solver, features, self)
    character(*), intent(in) :: program
    type(tandem_motion_solver), intent(inout) :: solver
    character(*), intent(in) :: features(:)
    type(c_ptr), intent(in), optional :: self
    type(text_for_c), allocatable, target :: words(:), names(:)
    type(c_ptr), allocatable, target :: argv(:), list(:)
    type(c_ptr) :: given
    given = c_null_ptr
    if (present(self)) given = self
    call own_command_line(words, argv)
    call texts_for_c(features, names, list)
    solver%size = c_sizeof(solver)
    solver%features = c_loc(list)
    call exit_with(tandem_c_motion_main(size(words), argv, program // c_null_char, solver, given))
  end subroutine

  subroutine tandem_load_run(program, solver, features, self)
    character(*), intent(in) :: program
    type(tandem_load_solver), intent(inout) :: solver
    character(*), intent(in) :: features(:)
    type(c_ptr), intent(in), optional :: self
    call run_load(program, solver, features, .false., self)
  end subroutine

  subroutine tandem_liquid_run(program, solver, features, self)
    character(*), intent(in) :: program
    type(tandem_load_solver), intent(inout) :: solver
    character(*), intent(in) :: features(:)
    type(c_ptr), intent(in), optional :: self
    call run_load(program, solver, features, .true., self)
  end subroutine

  subroutine run_load(program, solver, features, of_liquid, self)
    character(*), intent(in) :: program
    type(tandem_load_solver), intent(inout) :: solver
    character(*), intent(in) :: features(:)
    logical, intent(in) :: of_liquid
    type(c_ptr), intent(in), optional :: self
    type(text_for_c), allocatable, target :: words(:), names(:)
    type(c_ptr), allocatable, target :: argv(:), list(:)
    type(c_ptr) :: given
    given = c_null_ptr
    if (present(self)) given = self
    call own_command_line(words, argv)
    call texts_for_c(features, names, list)
    solver%size = c_sizeof(solver)
    solver%features = c_loc(list)
    if (of_liquid) then
      call exit_with(tandem_c_liquid_main(size(words), argv, program // c_null_char, solver, given))
    else
      call exit_with(tandem_c_load_main(size(words), argv, program // c_null_char, solver, given))
    end if
  end subroutine

  ! STOP with a number that is not known at compile time is not Fortran 2008.
  subroutine exit_with(status)
    integer(c_int), intent(in) :: status
    interface
      subroutine c_exit(code) bind(C, name="exit")
        import :: c_int
        integer(c_int), value :: code
      end subroutine
    end interface
    call c_exit(status)
  end subroutine

  function for_c(text) result(made)
    character(*), intent(in) :: text
    type(text_for_c) :: made
    integer :: i
    allocate (made%bytes(len(text) + 1))
    do i = 1, len(text)
      made%bytes(i) = text(i:i)
    end do
    made%bytes(len(text) + 1) = c_null_char
  end function

  ! `list` has the address of every text, and a null pointer at the end.
  subroutine texts_for_c(texts, kept, list)
    character(*), intent(in) :: texts(:)
    type(text_for_c), allocatable, target, intent(out) :: kept(:)
    type(c_ptr), allocatable, intent(out) :: list(:)
    integer :: i
    allocate (kept(size(texts)), list(size(texts) + 1))
    do i = 1, size(texts)
      kept(i) = for_c(trim(texts(i)))
      list(i) = c_loc(kept(i)%bytes)
    end do
    list(size(texts) + 1) = c_null_ptr
  end subroutine

  subroutine own_command_line(words, argv)
    type(text_for_c), allocatable, target, intent(out) :: words(:)
    type(c_ptr), allocatable, intent(out) :: argv(:)
    character(:), allocatable :: word
    integer :: i, length
    allocate (words(command_argument_count() + 1), argv(command_argument_count() + 2))
    do i = 1, size(words)
      call get_command_argument(i - 1, length=length)
      allocate (character(length) :: word)
      if (length > 0) call get_command_argument(i - 1, word)
      words(i) = for_c(word)
      argv(i) = c_loc(words(i)%bytes)
      deallocate (word)
    end do
    argv(size(argv)) = c_null_ptr
  end subroutine

end module
