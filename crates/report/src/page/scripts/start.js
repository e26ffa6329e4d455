'use strict';

plots.start();
