// httplib as the module includes it: without the macro that it brings and that breaks Eigen. Internal to the module.
#pragma once

#include <httplib.h>

#undef _res  // of <resolv.h>, which httplib includes; Eigen names arguments so
