#include "tandem/world/workcell.h"
