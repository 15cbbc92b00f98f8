// arm_neon.h, before the compiler's: products and sums of doubles are rounded one after the other, as on x86-64. Eigen fuses
// them where the processor can, whatever -ffp-contract says.
#pragma once

#include_next <arm_neon.h>

#define vfmaq_f64(c, a, b) vaddq_f64((c), vmulq_f64((a), (b)))
#define vfmaq_n_f64(c, a, b) vaddq_f64((c), vmulq_n_f64((a), (b)))
#define vfmaq_laneq_f64(c, a, b, lane) vaddq_f64((c), vmulq_laneq_f64((a), (b), (lane)))
