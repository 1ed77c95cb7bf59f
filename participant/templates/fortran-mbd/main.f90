! @NAME@: a multibody solver for tandem, in Fortran. Free rigid bodies under gravity and the load of the particles.
!
! Over a window of length H with the mean load F, T: velocity and angular momentum change by exactly F H + m g H and T H,
! and the position by H times the mean of the velocities at both ends, which is exact for a constant force. The
! orientation follows from the implicit midpoint rule: the body turns by H w, where w is the angular velocity that belongs
! to the mean angular momentum at the orientation half-way. docs/participant.md of tandem says what each function must do.
module free_bodies
  use, intrinsic :: iso_c_binding
  use tandem_participant
  implicit none
  integer, parameter :: dp = c_double

  type :: body_state
    real(dp) :: x(3), q(4), v(3), L(3)  ! pose; velocity, angular momentum about the centre of mass, world axes
  end type
  type(body_state), allocatable :: now(:), saved(:)
  type(tandem_body), pointer :: bodies(:)      ! of the scene
  real(dp), allocatable :: inverse(:, :, :)    ! of the inertia, axes of the body
  real(dp) :: gravity(3)

contains

  pure function cross(a, b) result(c)
    real(dp), intent(in) :: a(3), b(3)
    real(dp) :: c(3)
    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function

  ! Rotates by the quaternion q, or for sign = -1 by its inverse.
  pure function rotate(q, sign, v) result(r)
    real(dp), intent(in) :: q(4), sign, v(3)
    real(dp) :: r(3), a(3)
    a = cross(sign*q(2:4), v)
    r = v + 2*(q(1)*a + cross(sign*q(2:4), a))
  end function

  ! q turned further by the rotation vector phi, world axes; of unit length again.
  pure function turned(q, phi) result(r)
    real(dp), intent(in) :: q(4), phi(3)
    real(dp) :: r(4), angle, c, s(3)
    angle = norm2(phi)
    c = cos(angle/2)
    s = phi/2
    if (angle > 0) s = sin(angle/2)/angle*phi
    r(1) = c*q(1) - dot_product(s, q(2:4))
    r(2:4) = c*q(2:4) + q(1)*s + cross(s, q(2:4))
    r = r/norm2(r)
  end function

  ! The angular velocity of body b (from 1) with angular momentum L at the orientation q.
  function angular_velocity(b, q, L) result(w)
    integer, intent(in) :: b
    real(dp), intent(in) :: q(4), L(3)
    real(dp) :: w(3)
    w = rotate(q, 1.0_dp, matmul(inverse(:, :, b), rotate(q, -1.0_dp, L)))
  end function

  ! Under the torque T: I w' = T - w x L.
  function angular_acceleration(b, body, T) result(a)
    integer, intent(in) :: b
    type(body_state), intent(in) :: body
    real(dp), intent(in) :: T(3)
    real(dp) :: a(3)
    a = angular_velocity(b, body%q, T - cross(angular_velocity(b, body%q, body%L), body%L))
  end function

  function pose_of(body) result(pose)
    type(body_state), intent(in) :: body
    type(tandem_pose) :: pose
    pose = tandem_pose(body%x, body%q)
  end function

  function twist_of(b, body) result(twist)
    integer, intent(in) :: b
    type(body_state), intent(in) :: body
    type(tandem_twist) :: twist
    twist = tandem_twist(body%v, angular_velocity(b, body%q, body%L))
  end function

  integer(c_int) function configure(self, scene, initial, facts) bind(C, name='') result(status)
    type(c_ptr), value :: self, facts
    type(tandem_configuration), intent(in) :: scene
    type(tandem_motion_set), intent(in) :: initial
    type(tandem_body_motion), pointer :: m(:)
    real(dp) :: I(3, 3), rows(3, 3)
    integer :: b, k
    status = tandem_ok
    bodies => tandem_bodies(scene)
    gravity = scene%gravity
    allocate (now(size(bodies)), saved(size(bodies)), inverse(3, 3, size(bodies)))
    do b = 1, size(bodies)
      I = bodies(b)%inertia  ! symmetric: the cofactors, divided by the determinant
      rows(:, 1) = cross(I(:, 2), I(:, 3))
      rows(:, 2) = cross(I(:, 3), I(:, 1))
      rows(:, 3) = cross(I(:, 1), I(:, 2))
      inverse(:, :, b) = rows/dot_product(I(:, 1), rows(:, 1))
      now(b)%x = bodies(b)%pose%position
      now(b)%q = bodies(b)%pose%quaternion
      now(b)%v = bodies(b)%twist%velocity
      now(b)%L = rotate(now(b)%q, 1.0_dp, matmul(I, rotate(now(b)%q, -1.0_dp, bodies(b)%twist%angular_velocity)))
    end do
    m => tandem_motions(initial)  ! pose and twist are those of the scene already
    do k = 1, size(m)
      b = m(k)%body + 1
      m(k)%begin_acceleration = gravity
      m(k)%end_acceleration = gravity
      m(k)%begin_angular_acceleration = angular_acceleration(b, now(b), [0.0_dp, 0.0_dp, 0.0_dp])
      m(k)%end_angular_acceleration = m(k)%begin_angular_acceleration
    end do
    call tandem_fact_text(facts, 'method', 'free bodies, implicit midpoint rule')
  end function

  integer(c_int) function advance(self, loads, motion) bind(C, name='') result(status)
    type(c_ptr), value :: self
    type(tandem_load_set), intent(in) :: loads
    type(tandem_motion_set), intent(in) :: motion
    type(tandem_body_load), pointer :: given(:)
    type(tandem_body_motion), pointer :: m(:)
    type(body_state) :: old
    real(dp) :: H, F(3), T(3), a(3), moved(3), w(3)
    integer :: b, k
    H = tandem_length(motion%window)
    given => tandem_loads(loads)
    m => tandem_motions(motion)
    do b = 1, size(now)
      F = 0
      T = 0
      do k = 1, size(given)
        if (given(k)%body == b - 1) F = given(k)%mean%force
        if (given(k)%body == b - 1) T = given(k)%mean%torque
      end do
      old = now(b)
      a = F/bodies(b)%mass + gravity
      moved = H*(old%v + H/2*a)
      status = mean_angular_velocity(b, old%q, old%L + H/2*T, H, w)
      if (status /= tandem_ok) return
      now(b) = body_state(old%x + moved, turned(old%q, H*w), old%v + H*a, old%L + H*T)
      do k = 1, size(m)
        if (m(k)%body /= b - 1) cycle
        m(k)%begin_pose = pose_of(old)
        m(k)%end_pose = pose_of(now(b))
        m(k)%begin_twist = twist_of(b, old)
        m(k)%end_twist = twist_of(b, now(b))
        m(k)%begin_acceleration = a
        m(k)%end_acceleration = a
        m(k)%begin_angular_acceleration = angular_acceleration(b, old, T)
        m(k)%end_angular_acceleration = angular_acceleration(b, now(b), T)
        m(k)%applied_impulse = tandem_wrench(H*F, H*T)
        m(k)%applied_work = dot_product(F, moved) + H*dot_product(T, w)
      end do
    end do
    status = tandem_ok
  end function

  integer(c_int) function mean_angular_velocity(b, q, L, H, w) result(status)
    integer, intent(in) :: b
    real(dp), intent(in) :: q(4), L(3), H
    real(dp), intent(out) :: w(3)
    real(dp) :: change(3)
    integer :: pass
    status = tandem_ok
    w = angular_velocity(b, q, L)
    do pass = 1, 100  ! each pass reduces the error by a factor of H |w|
      change = angular_velocity(b, turned(q, H/2*w), L) - w
      w = w + change
      if (H*norm2(change) <= 1e-14_dp) return
    end do
    status = tandem_fail(tandem_error_numerics, 'the rotation of a body over a window has not been found', &
                         tandem_text(bodies(b)%name), 'take shorter windows')
  end function

  integer(c_int) function predict(self, window, motion) bind(C, name='') result(status)
    type(c_ptr), value :: self
    type(tandem_window), intent(in) :: window
    type(tandem_motion_set), intent(in) :: motion
    type(tandem_body_motion), pointer :: m(:)
    real(dp) :: H
    integer :: b, k
    H = tandem_length(window)
    m => tandem_motions(motion)
    do k = 1, size(m)
      b = m(k)%body + 1
      m(k)%begin_pose = pose_of(now(b))
      m(k)%begin_twist = twist_of(b, now(b))
      m(k)%end_twist = m(k)%begin_twist
      m(k)%end_pose = tandem_pose(now(b)%x + H*now(b)%v, turned(now(b)%q, H*m(k)%begin_twist%angular_velocity))
    end do
    status = tandem_ok
  end function

  integer(c_int) function observe(self, frame) bind(C, name='') result(status)
    type(c_ptr), value :: self
    type(tandem_bodies_frame), intent(inout) :: frame
    type(tandem_body_state), pointer :: states(:)
    integer :: b
    states => tandem_states(frame)
    do b = 1, size(states)
      states(b)%pose = pose_of(now(b))
      states(b)%twist = twist_of(b, now(b))
      frame%energy = frame%energy + bodies(b)%mass*(dot_product(now(b)%v, now(b)%v)/2 - dot_product(gravity, now(b)%x)) &
                     + dot_product(states(b)%twist%angular_velocity, now(b)%L)/2
    end do
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
  use free_bodies
  implicit none
  type(tandem_motion_solver) :: solver
  character(1) :: features(0)  ! a scene with a joint or a force is refused
  solver%capabilities = ior(tandem_can_predict, tandem_can_rollback)
  solver%configure = c_funloc(configure)
  solver%advance = c_funloc(advance)
  solver%observe = c_funloc(observe)
  solver%report = c_funloc(report)
  solver%predict = c_funloc(predict)
  solver%save = c_funloc(save)
  solver%restore = c_funloc(restore)
  call tandem_motion_run('@NAME@ 0.1', solver, features)
end program
