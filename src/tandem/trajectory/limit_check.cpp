#include "tandem/trajectory/limit_check.h"
