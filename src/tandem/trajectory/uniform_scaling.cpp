#include "tandem/trajectory/time_optimizer.h"
