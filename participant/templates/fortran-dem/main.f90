! @NAME@: a particle solver for tandem, in Fortran. Spheres with linear springs and dashpots, without friction and
! therefore without rotation, against each other, planes and triangles. Velocity Verlet; docs/participant.md of tandem says
! what each function must do.
module spheres
  use, intrinsic :: iso_c_binding
  use tandem_participant
  implicit none
  integer, parameter :: dp = c_double
  integer, parameter :: most_contacts = 16  ! of one sphere with one wall

  type :: memory  ! what save() keeps
    integer(c_int32_t), allocatable :: id(:), material(:)
    real(dp), allocatable :: x(:, :), v(:, :), radius(:), mass(:)
    integer(c_int64_t) :: lost = 0
    real(dp) :: largest_overlap = 0
  end type
  type(memory), target :: now, saved
  type(tandem_configuration) :: scene
  type(tandem_wall), pointer :: walls(:)
  real(dp), allocatable :: force(:, :)
  real(dp), allocatable :: stiffness(:, :), damping(:, :)  ! of two materials: k, negative without a pair; c / sqrt(m* k)
  integer, allocatable :: order(:)                         ! spheres by x
  integer(c_int64_t) :: contacts
  real(c_float), allocatable, target :: velocity(:, :), spin(:, :), radius(:)  ! for observe()

contains

  pure function cross(a, b) result(c)
    real(dp), intent(in) :: a(3), b(3)
    real(dp) :: c(3)
    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function

  ! From the frame of a body into the world, or for sign = -1 back.
  pure function rotate(q, sign, v) result(r)
    real(dp), intent(in) :: q(4), sign, v(3)
    real(dp) :: r(3), a(3)
    a = cross(sign*q(2:4), v)
    r = v + 2*(q(1)*a + cross(sign*q(2:4), a))
  end function

  integer(c_int) function configure(self, given, facts) bind(C, name='') result(status)
    type(c_ptr), value :: self, facts
    type(tandem_configuration), intent(in) :: given
    type(tandem_pair), pointer :: pairs(:)
    type(tandem_material), pointer :: materials(:)
    real(dp), parameter :: pi = acos(-1.0_dp)
    real(dp) :: l, alpha
    integer :: i, a, b
    scene = given
    walls => tandem_walls(scene)
    pairs => tandem_pairs(scene)
    materials => tandem_materials(scene)
    if (.not. scene%micro_step > 0) then
      status = tandem_fail(tandem_error_scene, 'no step of the particles is given', 'dem.micro_step', &
                           'give a number: this solver chooses none itself')
      return
    end if
    allocate (stiffness(size(materials), size(materials)), source=-1.0_dp)
    allocate (damping(size(materials), size(materials)), source=0.0_dp)
    do i = 1, size(pairs)
      if (pairs(i)%friction /= 0) then
        status = tandem_fail(tandem_error_scene, 'a pair has friction, which this solver does not know', 'dem.pairs', &
                             'write "friction": 0')
        return
      end if
      alpha = 2
      if (pairs(i)%restitution > 0) then
        l = log(pairs(i)%restitution)
        alpha = -2*l/sqrt(l**2 + pi**2)
      end if
      a = pairs(i)%a + 1
      b = pairs(i)%b + 1
      stiffness(a, b) = pairs(i)%spring_stiffness
      stiffness(b, a) = stiffness(a, b)
      damping(a, b) = alpha
      damping(b, a) = alpha
    end do
    now%x = tandem_sphere_position(scene)
    now%v = tandem_sphere_velocity(scene)
    now%radius = tandem_sphere_radius(scene)
    now%material = tandem_sphere_material(scene)
    now%id = [(i - 1, i=1, size(now%radius))]
    now%mass = 4*pi/3*now%radius**3*materials(now%material + 1)%density
    call tandem_fact_text(facts, 'method', 'velocity Verlet, pairs by sweeping along x')
    status = tandem_ok
  end function

  ! Normal force at an overlap > 0; `speed` is that of separation. Fails for materials (from 0) without a pair.
  integer(c_int) function normal_force(a, b, mass, r, overlap, speed, f) result(status)
    integer(c_int32_t), intent(in) :: a, b
    real(dp), intent(in) :: mass, r, overlap, speed
    real(dp), intent(out) :: f
    real(dp) :: k
    k = stiffness(a + 1, b + 1)
    f = 0
    if (k < 0) then
      status = tandem_fail(tandem_error_scene, 'two materials without a pair are in contact', 'dem.pairs', 'add the pair')
      return
    end if
    f = k*overlap - damping(a + 1, b + 1)*sqrt(mass*k)*speed
    now%largest_overlap = max(now%largest_overlap, overlap/r)
    status = tandem_ok
  end function

  ! Equal places are in the order of the spheres, so that sums do not depend on earlier windows.
  logical function behind(a, b)
    integer, intent(in) :: a, b
    behind = now%x(1, a) > now%x(1, b) .or. (now%x(1, a) == now%x(1, b) .and. a > b)
  end function

  ! Forces between spheres. Sorted by x, a sphere has its partners close behind it.
  integer(c_int) function pair_forces() result(status)
    integer :: p, q, i, j
    real(dp) :: largest, d(3), distance, overlap, f
    status = tandem_ok
    contacts = 0
    largest = maxval(now%radius)
    do p = 2, size(order)
      i = order(p)
      q = p
      do while (q > 1)
        if (.not. behind(order(q - 1), i)) exit
        order(q) = order(q - 1)
        q = q - 1
      end do
      order(q) = i
    end do
    do p = 1, size(order)
      do q = p + 1, size(order)
        i = order(p)
        j = order(q)
        if (now%x(1, j) - now%x(1, i) > now%radius(i) + largest) exit
        d = now%x(:, i) - now%x(:, j)
        distance = norm2(d)
        overlap = now%radius(i) + now%radius(j) - distance
        if (overlap <= 0 .or. distance == 0) cycle
        d = d/distance
        status = normal_force(now%material(i), now%material(j), now%mass(i)*now%mass(j)/(now%mass(i) + now%mass(j)), &
                              min(now%radius(i), now%radius(j)), overlap, dot_product(now%v(:, i) - now%v(:, j), d), f)
        if (status /= tandem_ok) return
        force(:, i) = force(:, i) + f*d
        force(:, j) = force(:, j) - f*d
        contacts = contacts + 1
      end do
    end do
  end function

  ! The point of a triangle (3 vertices) next to p [Ericson, Real-Time Collision Detection, 2005, section 5.1.5].
  pure function closest_point(t, p) result(c)
    real(dp), intent(in) :: t(3, 3), p(3)
    real(dp) :: c(3), ab(3), ac(3), d1, d2, d3, d4, d5, d6, va, vb, vc
    ab = t(:, 2) - t(:, 1)
    ac = t(:, 3) - t(:, 1)
    d1 = dot_product(ab, p - t(:, 1))
    d2 = dot_product(ac, p - t(:, 1))
    d3 = dot_product(ab, p - t(:, 2))
    d4 = dot_product(ac, p - t(:, 2))
    d5 = dot_product(ab, p - t(:, 3))
    d6 = dot_product(ac, p - t(:, 3))
    va = d3*d6 - d5*d4
    vb = d5*d2 - d1*d6
    vc = d1*d4 - d3*d2
    if (d1 <= 0 .and. d2 <= 0) then
      c = t(:, 1)
    else if (d3 >= 0 .and. d4 <= d3) then
      c = t(:, 2)
    else if (vc <= 0 .and. d1 >= 0 .and. d3 <= 0) then
      c = t(:, 1) + d1/(d1 - d3)*ab
    else if (d6 >= 0 .and. d5 <= d6) then
      c = t(:, 3)
    else if (vb <= 0 .and. d2 >= 0 .and. d6 <= 0) then
      c = t(:, 1) + d2/(d2 - d6)*ac
    else if (va <= 0 .and. d4 >= d3 .and. d5 >= d6) then
      c = t(:, 2) + (d4 - d3)/(d4 - d3 + d5 - d6)*(t(:, 3) - t(:, 2))
    else
      c = t(:, 1) + (vb*ab + vc*ac)/(va + vb + vc)
    end if
  end function

  ! Points of a wall that a sphere at p touches, in the frame of the wall's body, with unit normals towards the sphere. The
  ! deepest come first; further points in the tangent plane of one of them belong to the same face.
  integer(c_int) function find_touches(wall, p, r, n, point, normal, overlap) result(status)
    type(tandem_wall), intent(in) :: wall
    real(dp), intent(in) :: p(3), r
    integer, intent(out) :: n
    real(dp), intent(out) :: point(3, most_contacts), normal(3, most_contacts), overlap(most_contacts)
    real(dp), pointer :: triangles(:, :, :)
    real(dp) :: c(3), distance, deepest
    logical :: same_face
    integer :: t, k
    status = tandem_ok
    n = 0
    if (wall%shape == tandem_wall_plane) then
      distance = dot_product(p - wall%point, wall%normal)
      normal(:, 1) = wall%normal
      point(:, 1) = p - distance*wall%normal
      overlap(1) = r - distance
      if (overlap(1) > 0) n = 1
      return
    end if
    triangles => tandem_triangles(wall)
    do
      if (n == most_contacts) then
        status = tandem_fail(tandem_error_numerics, 'a sphere touches more than 16 faces of a wall', tandem_text(wall%name), &
                             'take a coarser mesh, or smaller spheres')
        return
      end if
      deepest = 0
      do t = 1, size(triangles, 3)
        c = closest_point(triangles(:, :, t), p)
        distance = norm2(p - c)
        if (r - distance <= deepest .or. distance == 0) cycle
        same_face = .false.
        do k = 1, n
          same_face = same_face .or. abs(dot_product(c - point(:, k), normal(:, k))) < 1e-6_dp*r
        end do
        if (same_face) cycle
        deepest = r - distance
        overlap(n + 1) = deepest
        point(:, n + 1) = c
        normal(:, n + 1) = (p - c)/distance
      end do
      if (deepest == 0) return
      n = n + 1
    end do
  end function

  ! Load of the spheres on one body; adds the opposite to the forces of the spheres.
  integer(c_int) function wall_forces(body, pose, twist, load) result(status)
    integer(c_int32_t), intent(in) :: body
    type(tandem_pose), intent(in) :: pose
    type(tandem_twist), intent(in) :: twist
    type(tandem_wrench), intent(out) :: load
    real(dp) :: point(3, most_contacts), normal(3, most_contacts), overlap(most_contacts), arm(3), d(3), u(3), p(3), f
    integer :: w, i, n, c
    status = tandem_ok
    load%force = 0
    load%torque = 0
    do w = 1, size(walls)
      if (walls(w)%body /= body) cycle
      do i = 1, size(now%id)
        p = rotate(pose%quaternion, -1.0_dp, now%x(:, i) - pose%position)
        status = find_touches(walls(w), p, now%radius(i), n, point, normal, overlap)
        if (status /= tandem_ok) return
        do c = 1, n
          arm = rotate(pose%quaternion, 1.0_dp, point(:, c))
          d = rotate(pose%quaternion, 1.0_dp, normal(:, c))
          u = now%v(:, i) - twist%velocity - cross(twist%angular_velocity, arm)
          status = normal_force(now%material(i), walls(w)%material, now%mass(i), now%radius(i), overlap(c), dot_product(u, d), f)
          if (status /= tandem_ok) return
          force(:, i) = force(:, i) + f*d
          load%force = load%force - f*d
          load%torque = load%torque - f*cross(arm, d)
        end do
      end do
    end do
  end function

  subroutine remove_lost(momentum)
    real(dp), intent(out) :: momentum(3)
    logical :: inside(size(now%id))
    integer, allocatable :: kept(:)
    integer :: i
    momentum = 0
    do i = 1, size(inside)
      inside(i) = all(now%x(:, i) >= scene%domain_min .and. now%x(:, i) <= scene%domain_max)
      if (.not. inside(i)) momentum = momentum + now%mass(i)*now%v(:, i)
    end do
    if (all(inside)) return
    kept = pack([(i, i=1, size(inside))], inside)
    now%lost = now%lost + size(inside) - size(kept)
    now%id = now%id(kept)
    now%material = now%material(kept)
    now%x = now%x(:, kept)
    now%v = now%v(:, kept)
    now%radius = now%radius(kept)
    now%mass = now%mass(kept)
  end subroutine

  ! Verlet: half a kick, drift, forces, half a kick. The load of a body is the trapezoidal sum of the same forces, so that the
  ! impulses of spheres and bodies are opposite but for round-off.
  integer(c_int) function advance(self, motion, loads) bind(C, name='') result(status)
    type(c_ptr), value :: self
    type(tandem_motion_set), intent(in) :: motion
    type(tandem_load_set), intent(inout) :: loads
    type(tandem_body_motion), pointer :: paths(:)
    type(tandem_body_load), pointer :: load(:)
    type(tandem_pose) :: pose
    type(tandem_twist) :: twist
    real(dp) :: length, dt, weight, share, arm
    integer :: steps, step, b, k, i
    paths => tandem_motions(motion)
    load => tandem_loads(loads)
    length = tandem_length(motion%window)
    steps = ceiling(length/scene%micro_step*(1 - 1e-12_dp))
    dt = length/steps
    loads%account%momentum_begin = matmul(now%v, now%mass)
    call remove_lost(loads%account%lost_momentum)
    loads%account%gravity_impulse = sum(now%mass)*length*scene%gravity
    order = [(i, i=1, size(now%id))]
    do step = 0, steps
      weight = dt  ! of the trapezoidal sum
      if (step == 0 .or. step == steps) weight = dt/2
      force = 0*now%x
      status = pair_forces()
      if (status /= tandem_ok) return
      do b = 1, size(load)
        pose = tandem_pose([0, 0, 0], [1, 0, 0, 0])  ! the ground
        twist = tandem_twist([0, 0, 0], [0, 0, 0])
        do k = 1, size(paths)
          if (paths(k)%body /= load(b)%body) cycle
          status = tandem_pose_at(paths(k), motion%window, step*dt, pose, twist)
          if (status /= tandem_ok) return
        end do
        status = wall_forces(load(b)%body, pose, twist, load(b)%end)
        if (status /= tandem_ok) return
        share = weight/length
        arm = share*(step*dt - length/2)
        load(b)%mean%force = load(b)%mean%force + share*load(b)%end%force
        load(b)%mean%torque = load(b)%mean%torque + share*load(b)%end%torque
        load(b)%first_moment%force = load(b)%first_moment%force + arm*load(b)%end%force
        load(b)%first_moment%torque = load(b)%first_moment%torque + arm*load(b)%end%torque
        load(b)%work = load(b)%work + weight*(dot_product(load(b)%end%force, twist%velocity) &
                                              + dot_product(load(b)%end%torque, twist%angular_velocity))
      end do
      do i = 1, size(now%id)
        now%v(:, i) = now%v(:, i) + weight*(force(:, i)/now%mass(i) + scene%gravity)
        if (step < steps) now%x(:, i) = now%x(:, i) + dt*now%v(:, i)
      end do
    end do
    loads%account%momentum_end = matmul(now%v, now%mass)
    loads%account%kinetic_energy = sum(now%mass*sum(now%v**2, 1))/2
    loads%account%micro_steps = steps
    loads%account%micro_step = dt
    loads%account%largest_overlap_ratio = now%largest_overlap
    loads%account%lost_particles = now%lost
    loads%account%contacts = contacts
  end function

  integer(c_int) function observe(self, frame) bind(C, name='') result(status)
    type(c_ptr), value :: self
    type(tandem_particles_frame), intent(inout) :: frame
    velocity = real(now%v, c_float)
    spin = 0*velocity
    radius = real(now%radius, c_float)
    frame%count = size(now%id)
    frame%id = c_loc(now%id)
    frame%position = c_loc(now%x)
    frame%velocity = c_loc(velocity)
    frame%spin = c_loc(spin)
    frame%radius = c_loc(radius)
    status = tandem_ok
  end function

  integer(c_int) function report(self, facts) bind(C, name='') result(status)
    type(c_ptr), value :: self, facts
    status = tandem_ok
  end function

  integer(c_int) function save(self) bind(C, name='') result(status)
    type(c_ptr), value :: self
    saved = now
    status = tandem_ok
  end function

  integer(c_int) function restore(self) bind(C, name='') result(status)
    type(c_ptr), value :: self
    now = saved
    status = tandem_ok
  end function

end module

program main
  use spheres
  implicit none
  type(tandem_load_solver) :: solver
  solver%capabilities = ior(tandem_can_rollback, ior(tandem_can_interpolate, tandem_can_window_mean))
  solver%configure = c_funloc(configure)
  solver%advance = c_funloc(advance)
  solver%observe = c_funloc(observe)
  solver%report = c_funloc(report)
  solver%save = c_funloc(save)
  solver%restore = c_funloc(restore)
  call tandem_load_run('@NAME@ 0.1', solver, ['contact:hooke ', 'wall:plane    ', 'wall:triangles'])
end program
