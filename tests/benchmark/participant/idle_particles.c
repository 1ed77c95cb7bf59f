/* A load solver that answers at once, in C: what a window costs without Python. */
#include <stdlib.h>
#include <tandem/participant.h>

static int configure(void *self, const tandem_configuration *c, tandem_facts *facts) {
  (void)self, (void)c, (void)facts;
  return TANDEM_OK;
}
static int advance(void *self, const tandem_motion_set *motion, tandem_load_set *loads) {
  (void)self;
  loads->account.micro_steps = 1;
  loads->account.micro_step = 1e-9 * (double)(motion->window.end - motion->window.begin);
  return TANDEM_OK;
}
static int observe(void *self, tandem_particles_frame *frame) {
  (void)self, (void)frame;
  return TANDEM_OK;
}
static int report(void *self, tandem_facts *facts) {
  (void)self, (void)facts;
  return TANDEM_OK;
}

int main(int argc, char **argv) {
  static const char *const features[] = {"*", NULL};
  const tandem_load_solver table = {.size = sizeof table,
                                    .capabilities = TANDEM_CAN_INTERPOLATE | TANDEM_CAN_WINDOW_MEAN,
                                    .features = features,
                                    .configure = configure,
                                    .advance = advance,
                                    .observe = observe,
                                    .report = report};
  return tandem_load_main(argc, argv, "idle_c 1.0", &table, NULL);
}
