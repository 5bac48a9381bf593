#include "tandem/trajectory/nlopt/slsqp_time_optimizer.h"
